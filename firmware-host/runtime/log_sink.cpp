#include "firmware-host/runtime/log_sink.h"

#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

namespace pelorus {
namespace {

const char* word(LogLevel level) {
  switch (level) {
    case LogLevel::error:
      return "error";
    case LogLevel::warning:
      return "warning";
    case LogLevel::notice:
    case LogLevel::info:
      return "info";
  }
  return "info";
}

std::string clock_text() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  tm parts{};
  localtime_r(&now.tv_sec, &parts);
  std::array<char, 32> text{};
  const std::size_t length = strftime(text.data(), text.size(), "%H:%M:%S", &parts);
  std::snprintf(text.data() + length, text.size() - length, ".%03ld", now.tv_nsec / 1'000'000);
  return text.data();
}

}  // namespace

LogSink::LogSink(bool to_journal) : to_journal_(to_journal) {}

void LogSink::line(LogLevel level, const std::string& text) {
  // The journal takes each line for itself: each needs its priority.
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    if (to_journal_) {
      std::fprintf(stderr, "<%d>%s\n", static_cast<int>(level), part.c_str());
    } else {
      std::fprintf(stderr, "%s %-7s %s\n", clock_text().c_str(), word(level), part.c_str());
    }
    begin = end + 1;
  }
}

void LogSink::limited(LogLevel level, std::string_view cause, const std::string& text, Timestamp now) {
  const auto [entry, fresh] = causes_.try_emplace(std::string(cause));
  Cause& known = entry->second;
  if (!fresh && seconds(now - known.last) < 1.0) {
    ++known.held_back;
    return;
  }
  const std::string more = known.held_back > 0 ? " (" + std::to_string(known.held_back) + " more before)" : "";
  known = {now, 0};
  line(level, text + more);
}

bool stderr_is_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  if (stream == nullptr) return false;
  unsigned long long device = 0, inode = 0;
  if (std::sscanf(stream, "%llu:%llu", &device, &inode) != 2) return false;
  struct stat facts {};
  return ::fstat(STDERR_FILENO, &facts) == 0 && facts.st_dev == device && facts.st_ino == inode;
}

}  // namespace pelorus
