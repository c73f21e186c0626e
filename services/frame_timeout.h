#pragma once
// FrameTimeout: how long to wait for a pair before there are no pictures. Given, or three and a half periods of the
// rate at which pairs really come, so that it is told within five of them at any rate. The period is the median of the
// latest intervals: lost pairs, spells and jumps do not move it. Thread-bound; no allocation.

#include <cstdint>

#include "core/base/time.h"
#include "services/median_interval.h"

namespace pelorus {

class FrameTimeout {
 public:
  // `given_ms`: 0 = by the rate.
  explicit FrameTimeout(double given_ms);

  // A pair of this time came, `step` after the one before as the camera counts.
  void learn(Timestamp capture_time, std::uint64_t step);
  [[nodiscard]] Duration value() const { return value_; }

 private:
  bool given_;
  Duration value_;
  bool any_ = false;
  Timestamp last_;
  MedianInterval intervals_;
};

}  // namespace pelorus
