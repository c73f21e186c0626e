#include "core/kernels/patch.h"

#include <cmath>
#include <cstddef>

#include "core/kernels/cubic_spline.h"
#include "core/kernels/patch_totals.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/patch.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
// After highway.h, which sets the target.
#include "core/kernels/patch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch) {
  const Columns d;
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const TapVectors wu = broadcast(fixed_taps(cubic_spline(u - floor_u)));
  const TapVectors du = broadcast(fixed_taps(cubic_spline_derivative(u - floor_u)));
  const TapVectors wv = broadcast(fixed_taps(cubic_spline(v - floor_v)));
  const TapVectors dv = broadcast(fixed_taps(cubic_spline_derivative(v - floor_v)));
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    const std::uint8_t* p = image.row(static_cast<int>(floor_v) - 1) + static_cast<int>(floor_u) - 1 + c;
    Vec s0 = hn::Zero(d), s1 = s0, s2 = s0;  // rows filtered along u
    Vec g0 = s0, g1 = s0, g2 = s0;           // rows differentiated along u
    for (int r = -3; r < patch.size; ++r, p += image.stride) {
      const Vec a = load_pixels(p), b = load_pixels(p + 1), e = load_pixels(p + 2), f = load_pixels(p + 3);
      const Vec s3 = dot(wu, a, b, e, f);
      const Vec g3 = dot(du, a, b, e, f);
      if (r >= 0) {
        const std::size_t i = static_cast<std::size_t>(r) * kPatchStride + c;
        hn::StoreU(to_units(dot(wv, s0, s1, s2, s3)), d, patch.value.data() + i);
        hn::StoreU(to_units(dot(wv, g0, g1, g2, g3)), d, patch.gradient_u.data() + i);
        hn::StoreU(to_units(dot(dv, s0, s1, s2, s3)), d, patch.gradient_v.data() + i);
      }
      s0 = s1, s1 = s2, s2 = s3;
      g0 = g1, g1 = g2, g2 = g3;
    }
  }
}

// Subtracts the mean, applies the mask and adds up all products.
void normalise(PatchTemplate& patch) {
  const Columns d;
  const std::size_t end = static_cast<std::size_t>(patch.size) * kPatchStride;
  TemplateTotals totals;
  std::int64_t sum = 0;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    ProductSum count, value;
    for (std::size_t i = c; i < end; i += kPatchStride) {
      const Vec mask = load_row(patch.mask, i);
      count.add(mask, mask);
      value.add(hn::And(mask, load_row(patch.value, i)));
    }
    totals.count += count.total(), sum += value.total();
  }
  patch.mean = rounded_mean(sum, totals.count);
  const Vec mean = hn::Set(d, static_cast<std::int16_t>(patch.mean));
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    ProductSum f, u, v, ff, fu, fv, uu, uv, vv;
    for (std::size_t i = c; i < end; i += kPatchStride) {
      const Vec mask = load_row(patch.mask, i);
      const Vec value = hn::And(mask, hn::Sub(load_row(patch.value, i), mean));
      const Vec gu = hn::And(mask, load_row(patch.gradient_u, i));
      const Vec gv = hn::And(mask, load_row(patch.gradient_v, i));
      hn::StoreU(value, d, patch.value.data() + i);
      hn::StoreU(gu, d, patch.gradient_u.data() + i);
      hn::StoreU(gv, d, patch.gradient_v.data() + i);
      f.add(value), u.add(gu), v.add(gv);
      ff.add(value, value), fu.add(value, gu), fv.add(value, gv);
      uu.add(gu, gu), uv.add(gu, gv), vv.add(gv, gv);
    }
    totals.value += f.total(), totals.u += u.total(), totals.v += v.total();
    totals.value_value += ff.total(), totals.value_u += fu.total(), totals.value_v += fv.total();
    totals.u_u += uu.total(), totals.u_v += uv.total(), totals.v_v += vv.total();
  }
  finish(totals, patch);
}

PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch) {
  const Columns d;
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const TapVectors wu = broadcast(fixed_taps(cubic_spline(u - floor_u)));
  const TapVectors wv = broadcast(fixed_taps(cubic_spline(v - floor_v)));
  const Vec mean = hn::Set(d, static_cast<std::int16_t>(patch.mean));
  ComparisonTotals totals;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    const std::uint8_t* p = image.row(static_cast<int>(floor_v) - 1) + static_cast<int>(floor_u) - 1 + c;
    Vec s0 = filter_row(wu, p), s1 = filter_row(wu, p + image.stride), s2 = filter_row(wu, p + 2 * image.stride);
    p += 3 * image.stride;
    ProductSum gradient_u, gradient_v, value, sum, square;
    const std::size_t end = static_cast<std::size_t>(patch.size) * kPatchStride;
    for (std::size_t i = c; i < end; i += kPatchStride, p += image.stride) {
      const Vec s3 = filter_row(wu, p);
      const Vec relative = hn::And(load_row(patch.mask, i), hn::Sub(to_units(dot(wv, s0, s1, s2, s3)), mean));
      gradient_u.add(load_row(patch.gradient_u, i), relative);
      gradient_v.add(load_row(patch.gradient_v, i), relative);
      value.add(load_row(patch.value, i), relative);
      sum.add(relative);
      square.add(relative, relative);
      s0 = s1, s1 = s2, s2 = s3;
    }
    totals.u += gradient_u.total(), totals.v += gradient_v.total(), totals.value += value.total();
    totals.sum += sum.total(), totals.square += square.total();
  }
  return finish(totals, patch);
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(sample_patch);
HWY_EXPORT(normalise);
HWY_EXPORT(compare_patch);

void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch) {
  HWY_DYNAMIC_DISPATCH(sample_patch)(image, u, v, patch);
}

void normalise(PatchTemplate& patch) { HWY_DYNAMIC_DISPATCH(normalise)(patch); }

PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch) {
  return HWY_DYNAMIC_DISPATCH(compare_patch)(image, u, v, patch);
}

}  // namespace pelorus
#endif
