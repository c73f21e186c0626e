#include "firmware-host/pelorus/replay/pair_feed.h"

#include <algorithm>
#include <thread>

namespace pelorus {

Result<bool> PairFeed::next(SourcePair& pair) {
  Result<bool> more = read(pair);
  if (!more || !more.value() || !options_.realtime) return more;
  if (!started_) {
    started_ = true;
    start_clock_ = Clock::now();
    start_time_ = pair.capture_time;
    return true;
  }
  while (is_superseded(pair)) {
    if (more = read(ahead_); !more) return more;
    if (!more.value()) return true;  // the last pair is the newest there is
    std::swap(pair, ahead_);
    ++dropped_;
  }
  wait_until(due(pair));
  return true;
}

Result<bool> PairFeed::read(SourcePair& pair) {
  if (options_.stop && options_.stop()) stopped_ = true;
  if (stopped_ || (options_.max_frames > 0 && read_ >= options_.max_frames)) return false;
  Result<bool> more = next_readable(pair);
  if (more.ok() && more.value()) {
    ++read_;
    if (has_last_) interval_ = pair.capture_time - last_time_;
    last_time_ = pair.capture_time;
    has_last_ = true;
  }
  return more;
}

// A damaged image costs its pair, told and counted; more of them in a row than the method bridges end the run. Before
// the first readable pair there is nothing to bridge.
Result<bool> PairFeed::next_readable(SourcePair& pair) {
  constexpr std::uint64_t kBridgedPairs = 3;
  for (std::uint64_t in_a_row = 0;; ++in_a_row) {
    Result<bool> more = source_.next(pair);
    if (more.ok()) return more;
    if (!first_unreadable_) first_unreadable_ = more.error();
    ++unreadable_;
    broke_off_ = in_a_row == kBridgedPairs && read_ > 0;
    if (broke_off_) return more;
    if (options_.warn) options_.warn(more.error());
  }
}

void PairFeed::wait_until(Clock::time_point time) const {
  constexpr auto kAskStopEvery = std::chrono::milliseconds(50);
  while (Clock::now() < time && !(options_.stop && options_.stop())) {
    std::this_thread::sleep_until(std::min(time, Clock::now() + kAskStopEvery));
  }
}

}  // namespace pelorus
