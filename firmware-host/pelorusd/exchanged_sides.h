#pragma once
// ExchangedSides: why nothing is found in good pictures. Live cameras whose left and right are exchanged (names,
// cables, addresses) give no pose, only LOST; here pairs that ended so are asked for and matched both ways
// (runtime/side_check.h). Once found, vision calls LOST a CALIBRATION_FAULT, and pairs are asked for on, until one
// matches as given or the state is another one; a repeated picture says nothing. Recorded pictures are checked before
// the start. Thread-bound to the main thread; a check takes some 0.1 s, and happens only without a pose: after 1, 2,
// 4 s and so on, in the end, and once a pair matched either way, each 60 s.

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

  // The present state; true when the pictures are found exchanged that were not known to be.
  [[nodiscard]] bool look(VisionState state, StateReason reason, Clock::time_point now);

 private:
  [[nodiscard]] bool judge(const SourcePair& pair, Clock::time_point now);

  VisionControl& control_;
  Mailbox<SourcePair>& lost_pairs_;
  const Rectifier& rectifier_;
  bool lost_ = false;
  int exchanged_ = 0;  // pairs, since one matched as given
  Clock::time_point next_ask_;
  std::chrono::seconds pause_{};  // after the next pair that is asked for
};

}  // namespace pelorus
