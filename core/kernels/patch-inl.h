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

using Columns = hn::CappedTag<std::int16_t, kPatchStride>;
using Vec = hn::VFromD<Columns>;
using Wide = hn::RepartitionToWide<Columns>;
using WideVec = hn::VFromD<Wide>;

struct TapVectors {
  Vec w0, w1, w2, w3;
};

HWY_INLINE TapVectors broadcast(const std::array<std::int16_t, 4>& w) {
  const Columns d;
  return {hn::Set(d, w[0]), hn::Set(d, w[1]), hn::Set(d, w[2]), hn::Set(d, w[3])};
}

// Products rounded to nearest; sums cannot overflow: taps sum to 1 at most and pixels stay below 2^15.
HWY_INLINE Vec dot(const TapVectors& w, Vec a, Vec b, Vec c, Vec e) {
  return hn::Add(hn::Add(hn::MulFixedPoint15(a, w.w0), hn::MulFixedPoint15(b, w.w1)),
                 hn::Add(hn::MulFixedPoint15(c, w.w2), hn::MulFixedPoint15(e, w.w3)));
}

// As fractions of 2^-7 grey level.
HWY_INLINE Vec load_pixels(const std::uint8_t* p) {
  const Columns d;
  const hn::Rebind<std::uint8_t, Columns> d8;
  return hn::ShiftLeft<7>(hn::PromoteTo(d, hn::LoadU(d8, p)));
}

HWY_INLINE Vec filter_row(const TapVectors& w, const std::uint8_t* p) {
  return dot(w, load_pixels(p), load_pixels(p + 1), load_pixels(p + 2), load_pixels(p + 3));
}

// From 2^-7 grey level to kPatchUnits.
HWY_INLINE Vec to_units(Vec v) { return hn::ShiftRight<2>(hn::Add(v, hn::Set(Columns(), std::int16_t{2}))); }

HWY_INLINE Vec load_row(const PatchRows& rows, std::size_t i) { return hn::LoadU(Columns(), rows.data() + i); }

// Sum of products of 16-bit numbers, exact: kPatchUnits leave room for 15 rows in 31 bits.
struct ProductSum {
  WideVec first;
  WideVec second;

  // Spelt out: a generated constructor would not be compiled for the target.
  HWY_INLINE ProductSum() : first(hn::Zero(Wide())), second(hn::Zero(Wide())) {}
  HWY_INLINE void add(Vec a, Vec b) { first = hn::ReorderWidenMulAccumulate(Wide(), a, b, first, second); }
  HWY_INLINE void add(Vec a) { add(a, hn::Set(Columns(), std::int16_t{1})); }
  HWY_INLINE std::int64_t total() const {
    const Wide d;
    alignas(64) std::int32_t lanes[kPatchStride];
    hn::Store(hn::Add(first, second), d, lanes);
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) sum += lanes[i];
    return sum;
  }
};

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
