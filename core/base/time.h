#pragma once
// Time of measurement: nanoseconds of the capture clock (Unix epoch for recorded data). Pure.
// No stage asks a clock what time it is; durations are std::chrono.

#include <chrono>
#include <compare>
#include <cstdint>

namespace pelorus {

using Duration = std::chrono::nanoseconds;

struct Timestamp {
  std::int64_t ns = 0;
  auto operator<=>(const Timestamp&) const = default;
};

constexpr Duration operator-(Timestamp later, Timestamp earlier) { return Duration(later.ns - earlier.ns); }
constexpr Timestamp operator+(Timestamp t, Duration d) { return Timestamp{t.ns + d.count()}; }
constexpr double seconds(Duration d) { return static_cast<double>(d.count()) * 1e-9; }

}  // namespace pelorus
