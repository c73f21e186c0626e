#pragma once
// DeviceClock: stamps of a camera's own clock, mapped to the capture clock.
//
// A free-running clock is found by its frames' arrivals: a frame can arrive late but never early, so that the least
// difference arrival - stamp of the last seconds is the offset (plus the least transfer time, a constant). After the
// first second a better offset reaches the stamps slowly, at most 500 microseconds a second, which is faster than any
// quartz drifts; stamps never go back by it.
// A clock set by PTP is that of the host, in UTC or TAI: its offset is 0 or -37 s exactly, and two cameras agree to
// the accuracy of PTP, not of arrivals. When it is neither, it is treated as free-running, and ptp_locked() says so.
//
// A stamp that goes back, lies in the future, or lags behind for longer than a busy host explains, is a jump: counted,
// the frame gets its time of arrival, and the offset is learned anew. Thread-bound; jumps() for all. O(1), no heap.

#include <cstdint>

#include "core/base/counter.h"
#include "core/base/time.h"

namespace pelorus {

enum class DeviceClockKind : std::uint8_t { free_running, ptp };

class DeviceClock {
 public:
  struct Mapped {
    Timestamp time;
    bool from_arrival = false;  // the stamp could not be believed
  };

  explicit DeviceClock(DeviceClockKind kind) : kind_(kind) {}

  // `device_ns`: the camera's stamp, nanoseconds of whatever origin. `arrival`: the same frame's, capture clock.
  [[nodiscard]] Mapped map(std::int64_t device_ns, Timestamp arrival);
  // After a restart of the camera.
  void reset();

  [[nodiscard]] bool ptp_locked() const { return ptp_locked_; }
  [[nodiscard]] std::uint64_t jumps() const { return jumps_.value(); }

 private:
  void learn(std::int64_t device_ns, Timestamp arrival);
  void find_exact_offset(std::int64_t lag_ns);
  [[nodiscard]] bool jumped(std::int64_t device_ns, Timestamp arrival);

  DeviceClockKind kind_;
  bool known_ = false;
  bool ptp_locked_ = false;
  std::int64_t offset_ns_ = 0;            // capture - device, as applied
  std::int64_t least_lag_ns_ = 0;         // of the running span of time ...
  std::int64_t least_lag_before_ns_ = 0;  // ... and of the one before
  Timestamp first_arrival_;
  Timestamp span_begin_;
  Timestamp last_in_time_;  // arrival of the last frame that was not late
  std::int64_t last_device_ns_ = 0;
  Counter jumps_;
};

}  // namespace pelorus
