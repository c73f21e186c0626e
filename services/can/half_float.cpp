#include "services/can/half_float.h"

#include <cmath>
#include <limits>

namespace pelorus {
namespace {

constexpr std::uint16_t kNan = 0x7E00;
constexpr std::uint16_t kInfinity = 0x7C00;
constexpr double kLargest = 65504;
constexpr int kLeastExponent = -14;  // of a normal number
constexpr int kMantissaBits = 10;

}  // namespace

std::uint16_t half_from(double value) {
  if (std::isnan(value) || value < 0) return kNan;
  if (value > kLargest) return kInfinity;
  if (value == 0) return 0;
  int exponent = std::ilogb(value);
  if (exponent < kLeastExponent) exponent = kLeastExponent;  // subnormal: no implicit one
  const double steps = std::ceil(std::ldexp(value, kMantissaBits - exponent));
  // Ceiling may carry into the next exponent; the encoding is continuous there, so that plain addition is right.
  const int biased = exponent - kLeastExponent;  // 0 for subnormal and the least normal exponent alike
  const int code = (biased << kMantissaBits) + static_cast<int>(steps);
  return static_cast<std::uint16_t>(code);
}

double half_value(std::uint16_t half) {
  const int exponent = (half >> kMantissaBits) & 0x1F;
  const int mantissa = half & 0x3FF;
  const double sign = (half & 0x8000) != 0 ? -1 : 1;
  if (exponent == 0x1F) {
    return mantissa == 0 ? sign * std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  }
  if (exponent == 0) return sign * std::ldexp(mantissa, kLeastExponent - kMantissaBits);
  return sign * std::ldexp(mantissa + 1024, exponent - 25);
}

}  // namespace pelorus
