#pragma once
// CaptureClock: Unix time that never steps. The kernel's monotonic clock plus an offset taken once, so that setting
// the wall clock (NTP, GPS) cannot tear the time between two frames. All cameras of a process share one; latencies are
// measured on it. Immutable after construction: thread-safe.

#include <cstdint>

#include "core/base/time.h"

namespace pelorus {

class CaptureClock {
 public:
  CaptureClock();

  [[nodiscard]] Timestamp now() const;
  // Of a stamp of CLOCK_MONOTONIC, as V4L2 gives.
  [[nodiscard]] Timestamp from_monotonic(std::int64_t monotonic_ns) const {
    return Timestamp{monotonic_ns + offset_ns_};
  }
  // How far the wall clock was stepped since construction.
  [[nodiscard]] Duration wall_step() const;

 private:
  std::int64_t offset_ns_ = 0;  // wall - monotonic
};

}  // namespace pelorus
