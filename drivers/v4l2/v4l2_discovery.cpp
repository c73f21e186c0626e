#include "drivers/v4l2/v4l2_discovery.h"

#include <algorithm>
#include <filesystem>

#include "drivers/v4l2/v4l2_device.h"

namespace pelorus {

std::vector<FoundDevice> find_v4l2_devices() {
  std::vector<FoundDevice> found;
  std::error_code unreadable;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", unreadable)) {
    if (!entry.path().filename().string().starts_with("video")) continue;
    V4l2Device device;
    const Result<> opened = device.open(entry.path().string());
    found.push_back({entry.path().string(), device.name(), opened ? "" : opened.error().message()});
  }
  std::sort(found.begin(), found.end(), [](const FoundDevice& a, const FoundDevice& b) { return a.path < b.path; });
  return found;
}

}  // namespace pelorus
