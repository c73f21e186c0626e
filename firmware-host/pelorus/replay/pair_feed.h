#pragma once
// PairFeed: the pairs of a source as a replay takes them. Damaged pairs are told of and bridged; in real-time mode each
// pair is released at its recorded time and, when the step was late, only the newest. Thread-bound; asks the clock in
// real-time mode only.

#include <chrono>
#include <cstdint>
#include <optional>

#include "drivers/stereo_source.h"
#include "firmware-host/pelorus/replay/replay_run.h"

namespace pelorus {

class PairFeed {
 public:
  // Both must outlive the feed.
  PairFeed(StereoSource& source, const ReplayOptions& options) : source_(source), options_(options) {}

  // False at the end of the data, at max_frames, or when asked to stop. An Error when the recording breaks off.
  [[nodiscard]] Result<bool> next(SourcePair& pair);

  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] std::uint64_t pairs_read() const { return read_; }
  [[nodiscard]] bool stopped() const { return stopped_; }
  [[nodiscard]] std::uint64_t unreadable() const { return unreadable_; }
  [[nodiscard]] MissingPairs missing() const { return source_.missing_pairs(); }
  [[nodiscard]] bool broke_off() const { return broke_off_; }
  [[nodiscard]] const std::optional<Error>& first_unreadable() const { return first_unreadable_; }

 private:
  using Clock = std::chrono::steady_clock;

  Result<bool> read(SourcePair& pair);
  Result<bool> next_readable(SourcePair& pair);
  Clock::time_point due(const SourcePair& pair) const { return start_clock_ + (pair.capture_time - start_time_); }
  // Its successor, one interval later, has been captured by now.
  bool is_superseded(const SourcePair& pair) const { return Clock::now() >= due(pair) + interval_; }
  void wait_until(Clock::time_point time) const;

  StereoSource& source_;
  const ReplayOptions& options_;
  SourcePair ahead_;
  bool started_ = false;
  bool stopped_ = false;
  bool has_last_ = false;
  Clock::time_point start_clock_;
  Timestamp start_time_;
  Timestamp last_time_;
  Duration interval_{0};
  std::uint64_t read_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t unreadable_ = 0;
  bool broke_off_ = false;
  std::optional<Error> first_unreadable_;
};

}  // namespace pelorus
