#include "firmware-host/pelorusd/wall_step_watch.h"

#include <array>
#include <chrono>
#include <cstdio>

namespace pelorus {

std::optional<std::string> WallStepWatch::look(Duration wall_step) {
  constexpr Duration kTold = std::chrono::milliseconds(100);
  if (told_ || (wall_step <= kTold && wall_step >= -kTold)) return std::nullopt;
  told_ = true;
  std::array<char, 192> line{};
  std::snprintf(
      line.data(), line.size(),
      "the wall clock was set by %+.3f s since the start; all times keep the old setting (restart the service "
      "once the clock is right)",
      seconds(wall_step));
  return line.data();
}

}  // namespace pelorus
