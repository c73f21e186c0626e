#pragma once
// ExchangedSides: why nothing is found in good pictures. Live cameras whose left and right are exchanged (names,
// cables, addresses) give no pose, only LOST; here pairs that ended so are asked for and matched both ways
// (runtime/side_check.h). Once found, vision calls LOST a CALIBRATION_FAULT, until a pair ends otherwise. Recorded
// pictures are checked before the start. Thread-bound to the main thread; a check
// takes some 0.1 s, and happens only while LOST lasts and nothing is known: after 1, 2, 4 s and so on, in the end each
// 60 s.

#include <chrono>

#include "core/base/mailbox.h"
#include "core/geometry/rectifier.h"
#include "services/vision.h"

namespace pelorus {

class ExchangedSides {
 public:
  using Clock = std::chrono::steady_clock;
  // All borrowed. Gives the box room for pictures of that size: before any thread uses it.
  ExchangedSides(VisionControl& control, Mailbox<SourcePair>& lost_pairs, const Rectifier& rectifier);

  // The present state; true once for a time without a pose in which the pictures are found exchanged.
  [[nodiscard]] bool look(VisionState state, Clock::time_point now);

 private:
  VisionControl& control_;
  Mailbox<SourcePair>& lost_pairs_;
  const Rectifier& rectifier_;
  bool lost_ = false;
  bool decided_ = false;
  int exchanged_ = 0;
  Clock::time_point next_ask_;
  std::chrono::seconds pause_{};  // after the next pair that is asked for
};

}  // namespace pelorus
