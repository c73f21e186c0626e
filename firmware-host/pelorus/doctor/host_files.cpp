#include "firmware-host/pelorus/doctor/host_files.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

namespace pelorus {

namespace fs = std::filesystem;

fs::path HostFiles::below(const std::string& path) const { return root_ / fs::path(path).relative_path(); }

std::optional<std::string> HostFiles::text(const std::string& path) const {
  std::error_code ignored;
  if (fs::is_directory(below(path), ignored)) return std::nullopt;
  std::ifstream file(below(path));
  if (!file) return std::nullopt;
  std::ostringstream all;
  all << file.rdbuf();
  std::string text = all.str();
  text.erase(text.find_last_not_of(" \t\r\n") + 1);
  return text;
}

std::optional<long long> HostFiles::number(const std::string& path) const {
  const std::optional<std::string> read = text(path);
  long long number = 0;
  if (!read) return std::nullopt;
  const auto [end, error] = std::from_chars(read->data(), read->data() + read->size(), number);
  if (error != std::errc{} || end != read->data() + read->size()) return std::nullopt;
  return number;
}

std::vector<std::string> HostFiles::entries(const std::string& folder) const {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(below(folder), error)) {
    paths.push_back((fs::path(folder) / entry.path().filename()).string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool holds_capability(const HostFiles& files, int bit) {
  std::istringstream status(files.text("/proc/self/status").value_or(""));
  for (std::string word; status >> word;) {
    if (word != "CapEff:") continue;
    std::uint64_t mask = 0;
    status >> std::hex >> mask;
    return ((mask >> bit) & 1U) != 0;
  }
  return false;
}

}  // namespace pelorus
