#pragma once
// MedianInterval: the period of what comes again and again, as the median of the latest nine intervals: single losses,
// outages and jumps do not move it. Thread-bound; no allocation.

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/time.h"

namespace pelorus {

class MedianInterval {
 public:
  void add(Duration interval) { latest_[count_++ % kIntervals] = interval; }
  // Zero until three intervals are known.
  [[nodiscard]] Duration value() const {
    if (count_ < kEnough) return Duration::zero();
    std::array<Duration, kIntervals> sorted = latest_;
    const std::size_t count = std::min(count_, kIntervals);
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
    return sorted[count / 2];
  }

 private:
  static constexpr std::size_t kIntervals = 9;
  static constexpr std::size_t kEnough = 3;

  std::array<Duration, kIntervals> latest_{};
  std::size_t count_ = 0;
};

}  // namespace pelorus
