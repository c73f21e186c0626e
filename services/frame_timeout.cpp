#include "services/frame_timeout.h"

#include <algorithm>
#include <chrono>

namespace pelorus {
namespace {

// Told within five, of which the wait for the next pair and the release take up to one and a half. The half: after two
// lost pairs the next is three periods after the last, give or take its own delay, and is no fault.
constexpr int kHalfPeriods = 7;
constexpr Duration kUntilKnown = std::chrono::milliseconds(500);
constexpr Duration kShortest = std::chrono::milliseconds(60);  // what an ordinary computer may keep a thread waiting
constexpr Duration kLongest = std::chrono::seconds(10);

}  // namespace

FrameTimeout::FrameTimeout(double given_ms)
    : given_(given_ms > 0), value_(given_ ? Duration(static_cast<std::int64_t>(given_ms * 1e6)) : kUntilKnown) {}

void FrameTimeout::learn(Timestamp capture_time, std::uint64_t step) {
  if (given_) return;
  const Duration interval = (capture_time - last_) / static_cast<std::int64_t>(std::max<std::uint64_t>(step, 1));
  last_ = capture_time;
  if (!any_) {
    any_ = true;
    return;
  }
  intervals_.add(interval);
  const Duration period = intervals_.value();
  if (period > Duration::zero()) value_ = std::clamp(kHalfPeriods * period / 2, kShortest, kLongest);
}

}  // namespace pelorus
