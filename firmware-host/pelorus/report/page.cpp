#include "firmware-host/pelorus/report/page.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

namespace pelorus {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDataMark = "\"PELORUS_RUN_DATA\"";
constexpr int kHalvings = 6;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

Error io_error(const fs::path& path, const std::string& detail) {
  return {ErrorCode::io, path.string(), detail, "check path, rights and free space"};
}

bool write_whole(const fs::path& path, const std::string& text) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "wb"));
  if (!file) return false;
  const bool written = std::fwrite(text.data(), 1, text.size(), file.get()) == text.size();
  return written && std::fflush(file.get()) == 0;
}

Result<Ok> write_atomically(const fs::path& path, const std::string& text) {
  const fs::path partial = path.string() + ".partial";
  std::error_code error;
  if (!write_whole(partial, text)) {
    const std::string reason = std::strerror(errno);
    fs::remove(partial, error);
    return io_error(path, "cannot write the page: " + reason);
  }
  fs::rename(partial, path, error);
  if (!error) return Ok{};
  const std::string reason = error.message();
  fs::remove(partial, error);
  return io_error(path, "cannot put the page in its place: " + reason);
}

}  // namespace

Result<std::string> filled_page(std::string_view page, const std::string& data) {
  if (page.empty()) {
    return Error{ErrorCode::unsupported, "report", "this program was built without the report page",
                 "install nodejs and npm, configure with -DPELORUS_WITH_REPORT=ON and build again"};
  }
  const std::size_t mark = page.find(kDataMark);
  if (mark == std::string_view::npos || page.find(kDataMark, mark + 1) != std::string_view::npos) {
    return Error{ErrorCode::unsupported, "report", "the built-in page has not exactly one place for its data",
                 "build again from clean sources"};
  }
  std::string filled(page.substr(0, mark));
  filled.reserve(page.size() + data.size() + data.size() / 100);
  for (const char c : data) {
    // "</script>" or "<!--" in a name would end or change the element.
    if (c == '<') {
      filled += "\\u003c";
    } else {
      filled += c;
    }
  }
  filled += page.substr(mark + kDataMark.size());
  return filled;
}

Result<Ok> write_page(const fs::path& file, const ReportInput& input, std::size_t largest) {
  PageBudget budget;
  for (int halving = 0;; ++halving) {
    Result<std::string> page = filled_page(page_template(), page_data(input, budget));
    if (!page) return page.error();
    if (page.value().size() <= largest || halving == kHalvings) return write_atomically(file, page.value());
    budget = budget.halved();
  }
}

}  // namespace pelorus
