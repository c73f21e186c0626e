#pragma once
// IEEE 754 binary16 for the variances of a CAN FD frame. Pure.

#include <cstdint>

namespace pelorus {

// Rounded towards +infinity for finite values, so that a deviation is never understated; above 65504: infinity.
// Negative values are no variances and become NaN.
[[nodiscard]] std::uint16_t half_from(double value);
[[nodiscard]] double half_value(std::uint16_t half);

}  // namespace pelorus
