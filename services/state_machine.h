#pragma once
// Which state consumers see, from what the pipeline found and what is known of the pictures; the worst cause wins:
// STANDBY, CALIBRATION_FAULT, CAMERA_FAULT, LOST or INIT, DEGRADED, TRACKING. Whatever has no estimate is marked so:
// never zeros, never the last value with a good flag. Pure.

#include "services/capture_watch.h"
#include "services/publisher.h"

namespace pelorus {

struct Circumstances {
  bool standby = false;
  bool calibration_fits = true;
  bool pictures = true;          // false: none came in time
  bool sides_exchanged = false;  // found while LOST, see VisionControl
  CaptureVerdict capture{};
  std::uint64_t pairs_missed = 0;  // captured since the last result, but not used
};

// Whether the pair is worth a step of the pipeline at all.
[[nodiscard]] bool is_usable(const Circumstances& circumstances);
// Settles state, reason and validity of a result that was made, or not, under these circumstances.
void settle_state(const Circumstances& circumstances, Publication& publication);
// The same for a result that is released too late.
void settle_late(Publication& publication);

}  // namespace pelorus
