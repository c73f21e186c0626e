#pragma once
// The V4L2 devices of this computer that capture. Opens each for a moment; a device of another program is listed too.

#include <string>
#include <vector>

namespace pelorus {

struct FoundDevice {
  std::string path;     // "/dev/video0"
  std::string name;     // driver and card
  std::string problem;  // why it cannot be used; empty when it can
};

[[nodiscard]] std::vector<FoundDevice> find_v4l2_devices();

}  // namespace pelorus
