#include "core/kernels/local_maxima.h"

#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/local_maxima.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using FloatVec = hn::VFromD<Floats>;
using FloatMask = decltype(hn::Eq(hn::Zero(Floats()), hn::Zero(Floats())));

HWY_INLINE FloatMask over_earlier(FloatVec value, const float* p) { return hn::Ge(value, hn::LoadU(Floats(), p)); }
HWY_INLINE FloatMask over_later(FloatVec value, const float* p) { return hn::Gt(value, hn::LoadU(Floats(), p)); }

HWY_INLINE FloatMask over_three(FloatVec value, const float* p, bool later) {
  if (later) return hn::And(hn::And(over_later(value, p - 1), over_later(value, p)), over_later(value, p + 1));
  return hn::And(hn::And(over_earlier(value, p - 1), over_earlier(value, p)), over_earlier(value, p + 1));
}

HWY_INLINE FloatMask over_layer(FloatVec value, const float* const (&rows)[3], std::ptrdiff_t i, bool later) {
  return hn::And(over_three(value, rows[0] + i, later),
                 hn::And(over_three(value, rows[1] + i, later), over_three(value, rows[2] + i, later)));
}

int local_maxima(const LayerRows& rows, int first, int count, float threshold, std::int32_t* found) {
  const Floats d;
  const FloatVec least = hn::Set(d, threshold);
  const std::ptrdiff_t end = std::ptrdiff_t{first} + count;
  int size = 0;
  for (std::ptrdiff_t i = first; i < end; i += static_cast<std::ptrdiff_t>(hn::Lanes(d))) {
    const float* middle = rows[1][1] + i;
    const FloatVec value = hn::LoadU(d, middle);
    FloatMask is_maximum =
        hn::And(hn::Gt(value, least), hn::And(over_earlier(value, middle - 1), over_later(value, middle + 1)));
    if (hn::AllFalse(d, is_maximum)) continue;  // most of the image
    is_maximum =
        hn::And(is_maximum, hn::And(over_three(value, rows[1][0] + i, false), over_three(value, rows[1][2] + i, true)));
    if (hn::AllFalse(d, is_maximum)) continue;
    is_maximum =
        hn::And(is_maximum, hn::And(over_layer(value, rows[0], i, false), over_layer(value, rows[2], i, true)));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, is_maximum, bytes);
    for (unsigned bits = bytes[0] | static_cast<unsigned>(bytes[1]) << 8; bits != 0; bits &= bits - 1) {
      const std::ptrdiff_t at = i + __builtin_ctz(bits);
      if (at < end) found[size++] = static_cast<std::int32_t>(at);
    }
  }
  return size;
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(local_maxima);

int local_maxima(const LayerRows& rows, int first, int count, float threshold, std::int32_t* found) {
  return HWY_DYNAMIC_DISPATCH(local_maxima)(rows, first, count, threshold, found);
}

namespace reference {

int local_maxima(const LayerRows& rows, int first, int count, float threshold, std::int32_t* found) {
  int size = 0;
  for (int i = first; i < first + count; ++i) {
    const float value = rows[1][1][i];
    bool is_maximum = value > threshold;
    for (int k = 0; k < 27 && is_maximum; ++k) {
      const float other = rows[k / 9][k / 3 % 3][i + k % 3 - 1];
      is_maximum = k < 13 ? value >= other : k == 13 || value > other;
    }
    if (is_maximum) found[size++] = i;
  }
  return size;
}

}  // namespace reference
}  // namespace pelorus
#endif
