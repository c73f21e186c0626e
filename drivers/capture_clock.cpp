#include "drivers/capture_clock.h"

#include <time.h>

#include <limits>

namespace pelorus {
namespace {

std::int64_t read_ns(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

// The two clocks cannot be read at once: of several tries the one with the least time between the readings counts.
std::int64_t wall_minus_monotonic_ns() {
  std::int64_t best_span = std::numeric_limits<std::int64_t>::max();
  std::int64_t offset = 0;
  for (int i = 0; i < 5; ++i) {
    const std::int64_t before = read_ns(CLOCK_MONOTONIC);
    const std::int64_t wall = read_ns(CLOCK_REALTIME);
    const std::int64_t span = read_ns(CLOCK_MONOTONIC) - before;
    if (span < best_span) {
      best_span = span;
      offset = wall - before - span / 2;
    }
  }
  return offset;
}

}  // namespace

CaptureClock::CaptureClock() : offset_ns_(wall_minus_monotonic_ns()) {}

Timestamp CaptureClock::now() const { return from_monotonic(read_ns(CLOCK_MONOTONIC)); }

Duration CaptureClock::wall_step() const { return Duration(wall_minus_monotonic_ns() - offset_ns_); }

}  // namespace pelorus
