// The part of patch.h for slanted surfaces.
#include <cmath>

#include "core/kernels/cubic_spline.h"
#include "core/kernels/patch.h"
#include "core/kernels/patch_totals.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/patch_slant.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
// After highway.h, which sets the target.
#include "core/kernels/patch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {

// Gradient times offset, from kPatchUnits to PatchSlant::kUnits. The product itself may leave 16 bits: the offset
// enters as a fraction of 2^15 that brings the change of units with it.
HWY_INLINE Vec slope(Vec gradient, Vec offset) {
  static_assert(kPatchUnits / PatchSlant::kUnits == 8);
  return hn::MulFixedPoint15(gradient, hn::ShiftLeft<12>(offset));
}

void prepare_slant(const PatchTemplate& patch, PatchSlant& slant) {
  const Columns d;
  const std::size_t end = static_cast<std::size_t>(patch.size) * kPatchStride;
  const int center = (patch.size - 1) / 2;
  SlantTotals totals;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    const Vec column = hn::Iota(d, static_cast<std::int16_t>(static_cast<int>(c) - center));
    // The last column is never in use, and its offset may not fit the fraction.
    const Vec offset_x = hn::Min(column, hn::Set(d, static_cast<std::int16_t>(center)));
    Vec offset_y = hn::Set(d, static_cast<std::int16_t>(-center));
    ProductSum x, y, fx, fy, ux, uy, xx, xy, yy;
    for (std::size_t i = c; i < end; i += kPatchStride) {
      const Vec gradient = load_row(patch.gradient_u, i), value = load_row(patch.value, i);
      const Vec per_x = slope(gradient, offset_x);
      const Vec per_y = slope(gradient, offset_y);
      hn::StoreU(per_x, d, slant.slope_x.data() + i);
      hn::StoreU(per_y, d, slant.slope_y.data() + i);
      x.add(per_x), y.add(per_y);
      fx.add(value, per_x), fy.add(value, per_y);
      ux.add(gradient, per_x), uy.add(gradient, per_y);
      xx.add(per_x, per_x), xy.add(per_x, per_y), yy.add(per_y, per_y);
      offset_y = hn::Add(offset_y, hn::Set(d, std::int16_t{1}));
    }
    totals.x += x.total(), totals.y += y.total();
    totals.value_x += fx.total(), totals.value_y += fy.total();
    totals.u_x += ux.total(), totals.u_y += uy.total();
    totals.x_x += xx.total(), totals.x_y += xy.total(), totals.y_y += yy.total();
  }
  finish(totals, patch, slant);
}

SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                const PatchSlant& slant) {
  const Columns d;
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const TapVectors wu = broadcast(fixed_taps(cubic_spline(u - floor_u)));
  const TapVectors wv = broadcast(fixed_taps(cubic_spline(v - floor_v)));
  const Vec mean = hn::Set(d, static_cast<std::int16_t>(patch.mean));
  SlantComparisonTotals totals;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    const std::uint8_t* p = image.row(static_cast<int>(floor_v) - 1) + static_cast<int>(floor_u) - 1 + c;
    Vec s0 = filter_row(wu, p), s1 = filter_row(wu, p + image.stride), s2 = filter_row(wu, p + 2 * image.stride);
    p += 3 * image.stride;
    ProductSum gradient_u, gradient_v, value, sum, square, slope_x, slope_y;
    const std::size_t end = static_cast<std::size_t>(patch.size) * kPatchStride;
    for (std::size_t i = c; i < end; i += kPatchStride, p += image.stride) {
      const Vec s3 = filter_row(wu, p);
      const Vec relative = hn::And(load_row(patch.mask, i), hn::Sub(to_units(dot(wv, s0, s1, s2, s3)), mean));
      gradient_u.add(load_row(patch.gradient_u, i), relative);
      gradient_v.add(load_row(patch.gradient_v, i), relative);
      value.add(load_row(patch.value, i), relative);
      sum.add(relative), square.add(relative, relative);
      slope_x.add(load_row(slant.slope_x, i), relative);
      slope_y.add(load_row(slant.slope_y, i), relative);
      s0 = s1, s1 = s2, s2 = s3;
    }
    ComparisonTotals& plain = totals.plain;
    plain.u += gradient_u.total(), plain.v += gradient_v.total(), plain.value += value.total();
    plain.sum += sum.total(), plain.square += square.total();
    totals.x += slope_x.total(), totals.y += slope_y.total();
  }
  return finish(totals, patch, slant);
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(prepare_slant);
HWY_EXPORT(compare_slanted_patch);

void prepare_slant(const PatchTemplate& patch, PatchSlant& slant) { HWY_DYNAMIC_DISPATCH(prepare_slant)(patch, slant); }

SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                const PatchSlant& slant) {
  return HWY_DYNAMIC_DISPATCH(compare_slanted_patch)(image, u, v, patch, slant);
}

}  // namespace pelorus
#endif
