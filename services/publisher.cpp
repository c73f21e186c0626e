#include "services/publisher.h"

namespace pelorus {

const char* to_text(StateReason reason) {
  switch (reason) {
    case StateReason::none:
      return "";
    case StateReason::starting:
      return "starting";
    case StateReason::few_points:
      return "few points";
    case StateReason::ambiguous_world:
      return "which group is the world is unclear";
    case StateReason::deadline_missed:
      return "deadline missed";
    case StateReason::pairs_dropped:
      return "pairs dropped";
    case StateReason::time_jump:
      return "time stamps jumped";
    case StateReason::repeated_picture:
      return "picture repeated";
    case StateReason::no_pictures:
      return "no pictures";
    case StateReason::frozen_pictures:
      return "pictures frozen";
    case StateReason::calibration:
      return "calibration";
    case StateReason::exchanged_sides:
      return "left and right pictures exchanged";
    case StateReason::commanded:
      return "commanded";
  }
  return "?";
}

}  // namespace pelorus
