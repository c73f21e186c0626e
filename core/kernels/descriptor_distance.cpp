#include "core/kernels/descriptor_distance.h"

#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/descriptor_distance.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

float squared_distance(const std::array<float, 64>& a, const std::array<float, 64>& b) {
  const hn::CappedTag<float, 16> d;
  alignas(64) float columns[16];
  for (std::size_t c = 0; c < 16; c += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    for (std::size_t i = c; i < 64; i += 16) {
      const auto difference = hn::Sub(hn::LoadU(d, a.data() + i), hn::LoadU(d, b.data() + i));
      sum = hn::Add(sum, hn::Mul(difference, difference));
    }
    hn::StoreU(sum, d, columns + c);
  }
  for (std::size_t half = 8; half > 0; half /= 2) {
    for (std::size_t c = 0; c < half; ++c) columns[c] += columns[c + half];
  }
  return columns[0];
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(squared_distance);

float squared_distance(const std::array<float, 64>& a, const std::array<float, 64>& b) {
  return HWY_DYNAMIC_DISPATCH(squared_distance)(a, b);
}

namespace reference {
float squared_distance(const std::array<float, 64>& a, const std::array<float, 64>& b) {
  std::array<float, 16> columns{};
  for (std::size_t i = 0; i < 64; ++i) columns[i % 16] += (a[i] - b[i]) * (a[i] - b[i]);
  for (std::size_t half = 8; half > 0; half /= 2) {
    for (std::size_t c = 0; c < half; ++c) columns[c] += columns[c + half];
  }
  return columns[0];
}
}  // namespace reference

}  // namespace pelorus
#endif
