// Vector building blocks of the patch kernels; included once per instruction set by files that use
// hwy/foreach_target.h, hence the unusual guard.
#if defined(PELORUS_CORE_KERNELS_PATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PELORUS_CORE_KERNELS_PATCH_INL_H
#undef PELORUS_CORE_KERNELS_PATCH_INL_H
#else
#define PELORUS_CORE_KERNELS_PATCH_INL_H
#endif

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/kernels/patch.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Columns = hn::CappedTag<float, kPatchStride>;
using Vec = hn::VFromD<Columns>;
using Taps = std::array<float, 4>;

// No fused multiply-add anywhere: the same bits on every target (see the build's -ffp-contract=off).
HWY_INLINE Vec add_product(Vec sum, Vec a, Vec b) { return hn::Add(sum, hn::Mul(a, b)); }

struct TapVectors {
  Vec w0, w1, w2, w3;
};

HWY_INLINE TapVectors broadcast(const Taps& w) {
  const Columns d;
  return {hn::Set(d, w[0]), hn::Set(d, w[1]), hn::Set(d, w[2]), hn::Set(d, w[3])};
}

HWY_INLINE Vec dot(const TapVectors& w, Vec a, Vec b, Vec c, Vec e) {
  return hn::Add(hn::Add(hn::Mul(w.w0, a), hn::Mul(w.w1, b)), hn::Add(hn::Mul(w.w2, c), hn::Mul(w.w3, e)));
}

HWY_INLINE Vec load_pixels(const std::uint8_t* p) {
  const Columns d;
  const hn::Rebind<std::int32_t, Columns> di;
  const hn::Rebind<std::uint8_t, Columns> d8;
  return hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d8, p)));
}

// Vector sums of one patch, each in its own row of column sums; collected in a fixed order.
template <std::size_t kSums>
struct ColumnSums {
  alignas(64) float columns[kSums][kPatchStride];

  HWY_INLINE void put(std::size_t sum, std::size_t first_column, Vec v) {
    hn::StoreU(v, Columns(), columns[sum] + first_column);
  }
  float collect(std::size_t sum) {
    float* c = columns[sum];
    for (std::size_t half = kPatchStride / 2; half > 0; half /= 2) {
      for (std::size_t i = 0; i < half; ++i) c[i] += c[i + half];
    }
    return c[0];
  }
};

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
