#include "drivers/device_clock.h"

#include <algorithm>

namespace pelorus {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kSpan = 5 * kSecond;  // a drift of 50 ppm moves the offset by 0.25 ms in it
constexpr std::int64_t kEarly = 20 * kMs;    // no frame arrives before it was taken
constexpr std::int64_t kEarlyAtFirst = 250 * kMs;
constexpr std::int64_t kLate = 100 * kMs;            // a busy or stopped host makes frames late for a while ...
constexpr std::int64_t kLateFor = kSecond;           // ... not for this long
constexpr std::int64_t kTooLate = 5 * kSecond;       // no buffer holds a frame this long
constexpr std::int64_t kPtpNear = 250 * kMs;         // exposure and transfer take less
constexpr std::int64_t kTaiMinusUtc = 37 * kSecond;  // since 2017 (IERS Bulletin C)
constexpr double kSlewAtFirst = 0.5;                 // of the interval between frames: stamps still increase
constexpr double kSlew = 500e-6;

}  // namespace

void DeviceClock::reset() { known_ = false; }

DeviceClock::Mapped DeviceClock::map(std::int64_t device_ns, Timestamp arrival) {
  if (known_ && jumped(device_ns, arrival)) {
    jumps_.add();
    reset();
    return {arrival, true};
  }
  learn(device_ns, arrival);
  last_device_ns_ = device_ns;
  return {Timestamp{device_ns + offset_ns_}, false};
}

bool DeviceClock::jumped(std::int64_t device_ns, Timestamp arrival) {
  const std::int64_t late_ns = arrival.ns - device_ns - offset_ns_;
  // The first frame may have been late itself.
  const std::int64_t early_limit = arrival.ns - first_arrival_.ns < kSecond ? kEarlyAtFirst : kEarly;
  if (late_ns < kLate) last_in_time_ = arrival;
  return device_ns <= last_device_ns_ || late_ns < -early_limit || late_ns > kTooLate ||
         arrival.ns - last_in_time_.ns > kLateFor;
}

void DeviceClock::find_exact_offset(std::int64_t lag_ns) {
  ptp_locked_ = false;
  if (kind_ != DeviceClockKind::ptp) return;
  for (const std::int64_t exact : {std::int64_t{0}, -kTaiMinusUtc}) {
    if (lag_ns - exact < -kEarly || lag_ns - exact > kPtpNear) continue;
    offset_ns_ = exact;
    ptp_locked_ = true;
  }
}

void DeviceClock::learn(std::int64_t device_ns, Timestamp arrival) {
  const std::int64_t lag_ns = arrival.ns - device_ns;
  if (!known_) {
    known_ = true;
    offset_ns_ = least_lag_ns_ = least_lag_before_ns_ = lag_ns;
    first_arrival_ = span_begin_ = last_in_time_ = arrival;
    find_exact_offset(lag_ns);
    return;
  }
  if (ptp_locked_) return;
  if (arrival.ns - span_begin_.ns > kSpan) {
    least_lag_before_ns_ = least_lag_ns_;
    least_lag_ns_ = lag_ns;
    span_begin_ = arrival;
  }
  least_lag_ns_ = std::min(least_lag_ns_, lag_ns);
  const std::int64_t wanted = std::min(least_lag_ns_, least_lag_before_ns_) - offset_ns_;
  const double slew = arrival.ns - first_arrival_.ns < kSecond ? kSlewAtFirst : kSlew;
  const auto limit = static_cast<std::int64_t>(slew * static_cast<double>(device_ns - last_device_ns_));
  offset_ns_ += std::clamp(wanted, -limit, limit);
}

}  // namespace pelorus
