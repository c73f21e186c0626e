#pragma once
// The four taps of the cubic B-spline at fraction t in [0, 1) between taps 1 and 2, and their derivatives
// (Unser 1999). Taps sum to 1, derivatives to 0. Pure.

#include <array>
#include <cstdint>

namespace pelorus {

inline std::array<float, 4> cubic_spline(float t) {
  const float s = 1.0F - t;
  constexpr float kSixth = 1.0F / 6.0F;
  return {s * s * s * kSixth, (4.0F - 3.0F * t * t * (1.0F + s)) * kSixth, (4.0F - 3.0F * s * s * (1.0F + t)) * kSixth,
          t * t * t * kSixth};
}

inline std::array<float, 4> cubic_spline_derivative(float t) {
  const float s = 1.0F - t;
  return {-0.5F * s * s, t * (1.5F * t - 2.0F), s * (2.0F - 1.5F * s), 0.5F * t * t};
}

// As 16-bit fractions of 2^15, rounded to nearest; no tap reaches 1.
inline std::array<std::int16_t, 4> fixed_taps(const std::array<float, 4>& taps) {
  std::array<std::int16_t, 4> fixed{};
  for (std::size_t i = 0; i < 4; ++i) {
    // Shifted to positive numbers, for which truncation rounds down.
    fixed[i] = static_cast<std::int16_t>(static_cast<int>(taps[i] * 32768.0F + 65536.5F) - 65536);
  }
  return fixed;
}

}  // namespace pelorus
