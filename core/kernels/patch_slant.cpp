// The part of patch.h for slanted surfaces.
#include <algorithm>
#include <cmath>

#include "core/kernels/cubic_spline.h"
#include "core/kernels/patch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/patch_slant.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
// After highway.h, which sets the target.
#include "core/kernels/patch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {

void prepare_slant(const PatchTemplate& patch, PatchSlant& slant) {
  const Columns d;
  const std::size_t end = static_cast<std::size_t>(patch.size) * kPatchStride;
  const float center = 0.5F * static_cast<float>(patch.size - 1);
  const float* f = patch.value.data();
  const float* g = patch.gradient_u.data();
  const float* w = patch.weight.data();
  float* sx = slant.slope_x.data();
  float* sy = slant.slope_y.data();
  ColumnSums<5> sums;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    const Vec x = hn::Sub(hn::Iota(d, static_cast<float>(c)), hn::Set(d, center));
    Vec mean_x = hn::Zero(d), mean_y = mean_x, along_x = mean_x, along_y = mean_x;
    float row = -center;
    for (std::size_t i = c; i < end; i += kPatchStride, row += 1.0F) {
      const Vec gradient = hn::LoadU(d, g + i), weight = hn::LoadU(d, w + i), value = hn::LoadU(d, f + i);
      const Vec per_x = hn::Mul(gradient, x), per_y = hn::Mul(gradient, hn::Set(d, row));
      hn::StoreU(per_x, d, sx + i), hn::StoreU(per_y, d, sy + i);
      mean_x = add_product(mean_x, weight, per_x), mean_y = add_product(mean_y, weight, per_y);
      along_x = add_product(along_x, value, per_x), along_y = add_product(along_y, value, per_y);
    }
    sums.put(0, c, mean_x), sums.put(1, c, mean_y), sums.put(2, c, along_x), sums.put(3, c, along_y);
  }
  const float per_pixel = 1.0F / std::max(patch.count, 1.0F);
  const float scale = 1.0F / std::max(patch.energy, 1e-6F);
  const Vec mean_x = hn::Set(d, sums.collect(0) * per_pixel), mean_y = hn::Set(d, sums.collect(1) * per_pixel);
  const Vec along_x = hn::Set(d, sums.collect(2) * scale), along_y = hn::Set(d, sums.collect(3) * scale);
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    Vec ux = hn::Zero(d), uy = ux, xx = ux, xy = ux, yy = ux;
    for (std::size_t i = c; i < end; i += kPatchStride) {
      const Vec gradient = hn::LoadU(d, g + i), weight = hn::LoadU(d, w + i), value = hn::LoadU(d, f + i);
      const Vec x = hn::Sub(hn::Mul(weight, hn::Sub(hn::LoadU(d, sx + i), mean_x)), hn::Mul(along_x, value));
      const Vec y = hn::Sub(hn::Mul(weight, hn::Sub(hn::LoadU(d, sy + i), mean_y)), hn::Mul(along_y, value));
      hn::StoreU(x, d, sx + i), hn::StoreU(y, d, sy + i);
      ux = add_product(ux, gradient, x), uy = add_product(uy, gradient, y);
      xx = add_product(xx, x, x), xy = add_product(xy, x, y), yy = add_product(yy, y, y);
    }
    sums.put(0, c, ux), sums.put(1, c, uy), sums.put(2, c, xx), sums.put(3, c, xy), sums.put(4, c, yy);
  }
  slant.structure = {patch.structure_uu, sums.collect(0), sums.collect(1),
                     sums.collect(2),    sums.collect(3), sums.collect(4)};
}

SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                const PatchSlant& slant) {
  const Columns d;
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const TapVectors wu = broadcast(cubic_spline(u - floor_u));
  const TapVectors wv = broadcast(cubic_spline(v - floor_v));
  const Vec mean = hn::Set(d, patch.mean);
  ColumnSums<7> sums;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    const std::uint8_t* p = image.row(static_cast<int>(floor_v) - 1) + static_cast<int>(floor_u) - 1 + c;
    Vec s0 = hn::Zero(d), s1 = s0, s2 = s0;
    Vec gradient_u = s0, gradient_v = s0, value = s0, sum = s0, square = s0, slope_x = s0, slope_y = s0;
    for (int r = -3; r < patch.size; ++r, p += image.stride) {
      const Vec s3 = dot(wu, load_pixels(p), load_pixels(p + 1), load_pixels(p + 2), load_pixels(p + 3));
      if (r >= 0) {
        const std::size_t i = static_cast<std::size_t>(r) * kPatchStride + c;
        const Vec weight = hn::LoadU(d, patch.weight.data() + i);
        const Vec relative = hn::Mul(weight, hn::Sub(dot(wv, s0, s1, s2, s3), mean));
        gradient_u = add_product(gradient_u, hn::LoadU(d, patch.gradient_u.data() + i), relative);
        gradient_v = add_product(gradient_v, hn::LoadU(d, patch.gradient_v.data() + i), relative);
        value = add_product(value, hn::LoadU(d, patch.value.data() + i), relative);
        sum = hn::Add(sum, relative);
        square = add_product(square, relative, relative);
        slope_x = add_product(slope_x, hn::LoadU(d, slant.slope_x.data() + i), relative);
        slope_y = add_product(slope_y, hn::LoadU(d, slant.slope_y.data() + i), relative);
      }
      s0 = s1, s1 = s2, s2 = s3;
    }
    sums.put(0, c, gradient_u), sums.put(1, c, gradient_v), sums.put(2, c, value), sums.put(3, c, sum);
    sums.put(4, c, square), sums.put(5, c, slope_x), sums.put(6, c, slope_y);
  }
  return {{sums.collect(0), sums.collect(1), sums.collect(2), sums.collect(3), sums.collect(4)},
          sums.collect(5),
          sums.collect(6)};
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
