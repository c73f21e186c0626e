#include "firmware-host/pelorus/doctor/storage.h"

#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>

namespace pelorus {
namespace {

namespace fs = std::filesystem;

constexpr double kShortRecording_s = 600;

// The recorder makes missing folders: what exists of the path decides.
fs::path existing_part(const fs::path& folder) {
  std::error_code error;
  fs::path path = fs::absolute(folder, error);
  while (path.has_relative_path() && !fs::exists(path, error)) path = path.parent_path();
  return path;
}

}  // namespace

HostCheck check_storage(const RecorderConfig& config, const std::optional<PairFlow>& flow) {
  HostCheck check{Verdict::ok, "recorder's disk", "", ""};
  const Verdict bad = config.at_start ? Verdict::fail : Verdict::warn;
  const fs::path folder = existing_part(config.folder);
  std::error_code ignored;
  struct statvfs disk {};
  if (!fs::is_directory(folder, ignored) || ::statvfs(folder.c_str(), &disk) != 0) {
    return {bad, check.topic, folder.string() + " is no folder",
            "recorder.folder: a folder, or the name of one to make"};
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    return {bad, check.topic, folder.string() + " cannot be written",
            "chown pelorus " + folder.string() + ", or another recorder.folder"};
  }
  const double free_gb = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) / 1e9;
  std::array<char, 96> room{};
  std::snprintf(room.data(), room.size(), "%.1f GB free", free_gb);
  check.found = std::string(room.data()) + " at " + folder.string();
  if (free_gb < config.min_free_gb) {
    std::snprintf(room.data(), room.size(), ", below recorder.min_free_gb %.1f: nothing will be recorded",
                  config.min_free_gb);
    check.verdict = bad;
    check.found += room.data();
    check.cure = "free space, or another recorder.folder";
    return check;
  }
  if (!flow || flow->bytes == 0 || !(flow->rate_hz > 0)) return check;
  const double recorded_hz = flow->rate_hz / config.every;
  const double length_s = (free_gb - config.min_free_gb) * 1e9 / (static_cast<double>(flow->bytes) * recorded_hz);
  std::snprintf(room.data(), room.size(), ", at least %.0f min of %.1f pairs/s", length_s / 60, recorded_hz);
  check.found += room.data();
  if (length_s < kShortRecording_s) {
    check.verdict = Verdict::warn;
    check.cure = "free space, recorder.every: 2 or more, or another recorder.folder";
  }
  return check;
}

}  // namespace pelorus
