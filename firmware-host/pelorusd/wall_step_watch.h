#pragma once
// WallStepWatch: whether the wall clock was set since the service took its time from it, as on a computer without a
// battery whose clock comes from the network after the start: all times of the dive are off by that. Pure but for what
// it said. Thread-bound.

#include <optional>
#include <string>

#include "core/base/time.h"

namespace pelorus {

class WallStepWatch {
 public:
  // A warning with the cure, the first time that the step (CaptureClock::wall_step) exceeds 0.1 s.
  [[nodiscard]] std::optional<std::string> look(Duration wall_step);

 private:
  bool told_ = false;
};

}  // namespace pelorus
