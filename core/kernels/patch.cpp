#include "core/kernels/patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "core/kernels/cubic_spline.h"

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
  const TapVectors wu = broadcast(cubic_spline(u - floor_u));
  const TapVectors du = broadcast(cubic_spline_derivative(u - floor_u));
  const TapVectors wv = broadcast(cubic_spline(v - floor_v));
  const TapVectors dv = broadcast(cubic_spline_derivative(v - floor_v));
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
        hn::StoreU(dot(wv, s0, s1, s2, s3), d, patch.value.data() + i);
        hn::StoreU(dot(wv, g0, g1, g2, g3), d, patch.gradient_u.data() + i);
        hn::StoreU(dot(dv, s0, s1, s2, s3), d, patch.gradient_v.data() + i);
      }
      s0 = s1, s1 = s2, s2 = s3;
      g0 = g1, g1 = g2, g2 = g3;
    }
  }
}

// Spline taps and their derivatives for a vector of fractions: the operations of cubic_spline.h.
HWY_INLINE TapVectors spline_taps(Vec t) {
  const Columns d;
  const Vec s = hn::Sub(hn::Set(d, 1.0F), t);
  const Vec sixth = hn::Set(d, 1.0F / 6.0F);
  const Vec three = hn::Set(d, 3.0F), four = hn::Set(d, 4.0F), one = hn::Set(d, 1.0F);
  const Vec w1 = hn::Sub(four, hn::Mul(hn::Mul(hn::Mul(three, t), t), hn::Add(one, s)));
  const Vec w2 = hn::Sub(four, hn::Mul(hn::Mul(hn::Mul(three, s), s), hn::Add(one, t)));
  return {hn::Mul(hn::Mul(hn::Mul(s, s), s), sixth), hn::Mul(w1, sixth), hn::Mul(w2, sixth),
          hn::Mul(hn::Mul(hn::Mul(t, t), t), sixth)};
}

HWY_INLINE TapVectors spline_derivatives(Vec t) {
  const Columns d;
  const Vec s = hn::Sub(hn::Set(d, 1.0F), t);
  const Vec half = hn::Set(d, 0.5F), more = hn::Set(d, 1.5F), two = hn::Set(d, 2.0F);
  return {hn::Mul(hn::Mul(hn::Neg(half), s), s), hn::Mul(t, hn::Sub(hn::Mul(more, t), two)),
          hn::Mul(s, hn::Sub(two, hn::Mul(more, s))), hn::Mul(hn::Mul(half, t), t)};
}

// Four neighbouring pixels per lane, as floats.
struct PixelQuads {
  Vec p0, p1, p2, p3;
};

// `first` + offset[lane] is each lane's first pixel. Plain loads: gather instructions are no faster for bytes.
HWY_INLINE PixelQuads load_quads(const std::uint8_t* first, const std::int32_t* offset) {
  const Columns d;
  const hn::RebindToUnsigned<Columns> du;
  const hn::RebindToSigned<Columns> di;
  alignas(64) std::uint32_t packed[kPatchStride];
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) std::memcpy(packed + lane, first + offset[lane], 4);
  const auto v = hn::Load(du, packed);
  const auto byte = hn::Set(du, 0xFF);
  const auto to_float = [&](auto x) { return hn::ConvertTo(d, hn::BitCast(di, hn::And(x, byte))); };
  return {to_float(v), to_float(hn::ShiftRight<8>(v)), to_float(hn::ShiftRight<16>(v)),
          to_float(hn::ShiftRight<24>(v))};
}

void sample_warped_patch(const ImageView& image, float u, float v, const std::array<float, 4>& A,
                         PatchTemplate& patch) {
  const Columns d;
  const hn::RebindToSigned<Columns> di;
  const float center = 0.5F * static_cast<float>(patch.size - 1);
  const Vec zero = hn::Zero(d);
  const Vec last_u = hn::Set(d, static_cast<float>(image.width - 1));
  const Vec last_v = hn::Set(d, static_cast<float>(image.height - 1));
  const Vec a0 = hn::Set(d, A[0]), a1 = hn::Set(d, A[1]), a2 = hn::Set(d, A[2]), a3 = hn::Set(d, A[3]);
  const auto stride = static_cast<std::int32_t>(image.stride);
  const std::uint8_t* origin = image.pixels - stride - 1;
  for (int r = 0; r < patch.size; ++r) {
    const Vec y = hn::Set(d, static_cast<float>(r) - center);
    for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
      const Vec x = hn::Sub(hn::Iota(d, static_cast<float>(c)), hn::Set(d, center));
      const Vec wanted_u = hn::Add(hn::Set(d, u), hn::Add(hn::Mul(a0, x), hn::Mul(a1, y)));
      const Vec wanted_v = hn::Add(hn::Set(d, v), hn::Add(hn::Mul(a2, x), hn::Mul(a3, y)));
      const Vec pu = hn::Min(hn::Max(wanted_u, zero), last_u);
      const Vec pv = hn::Min(hn::Max(wanted_v, zero), last_v);
      const auto iu = hn::ConvertTo(di, pu);  // truncation: both are >= 0
      const auto iv = hn::ConvertTo(di, pv);
      const Vec fu = hn::Sub(pu, hn::ConvertTo(d, iu));
      const Vec fv = hn::Sub(pv, hn::ConvertTo(d, iv));
      alignas(64) std::int32_t offset[kPatchStride];
      hn::Store(hn::Add(hn::Mul(iv, hn::Set(di, stride)), iu), di, offset);
      const TapVectors wu = spline_taps(fu), du = spline_derivatives(fu);
      Vec rows[4], slopes[4];
      for (int k = 0; k < 4; ++k) {
        const PixelQuads q = load_quads(origin + k * image.stride, offset);
        rows[k] = dot(wu, q.p0, q.p1, q.p2, q.p3);
        slopes[k] = dot(du, q.p0, q.p1, q.p2, q.p3);
      }
      const TapVectors wv = spline_taps(fv), dv = spline_derivatives(fv);
      const Vec gu = dot(wv, slopes[0], slopes[1], slopes[2], slopes[3]);
      const Vec gv = dot(dv, rows[0], rows[1], rows[2], rows[3]);
      const std::size_t i = static_cast<std::size_t>(r) * kPatchStride + c;
      hn::StoreU(dot(wv, rows[0], rows[1], rows[2], rows[3]), d, patch.value.data() + i);
      hn::StoreU(hn::Add(hn::Mul(gu, a0), hn::Mul(gv, a2)), d, patch.gradient_u.data() + i);
      hn::StoreU(hn::Add(hn::Mul(gu, a1), hn::Mul(gv, a3)), d, patch.gradient_v.data() + i);
      const auto shown = hn::And(hn::Eq(pu, wanted_u), hn::Eq(pv, wanted_v));
      hn::StoreU(hn::IfThenElseZero(shown, hn::LoadU(d, patch.weight.data() + i)), d, patch.weight.data() + i);
    }
  }
}

void normalise(PatchTemplate& patch) {
  const Columns d;
  const std::size_t end = static_cast<std::size_t>(patch.size) * kPatchStride;
  float* f = patch.value.data();
  float* gu = patch.gradient_u.data();
  float* gv = patch.gradient_v.data();
  const float* w = patch.weight.data();
  ColumnSums<4> sums;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    Vec count = hn::Zero(d), value = count, mean_u = count, mean_v = count;
    for (std::size_t i = c; i < end; i += kPatchStride) {
      const Vec weight = hn::LoadU(d, w + i);
      count = hn::Add(count, weight);
      value = add_product(value, weight, hn::LoadU(d, f + i));
      mean_u = add_product(mean_u, weight, hn::LoadU(d, gu + i));
      mean_v = add_product(mean_v, weight, hn::LoadU(d, gv + i));
    }
    sums.put(0, c, count), sums.put(1, c, value), sums.put(2, c, mean_u), sums.put(3, c, mean_v);
  }
  patch.count = sums.collect(0);
  const float per_pixel = 1.0F / std::max(patch.count, 1.0F);
  patch.mean = sums.collect(1) * per_pixel;
  const Vec mean = hn::Set(d, patch.mean);
  const Vec mean_u = hn::Set(d, sums.collect(2) * per_pixel);
  const Vec mean_v = hn::Set(d, sums.collect(3) * per_pixel);
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    Vec energy = hn::Zero(d), along_u = energy, along_v = energy;
    for (std::size_t i = c; i < end; i += kPatchStride) {
      const Vec weight = hn::LoadU(d, w + i);
      const Vec value = hn::Mul(weight, hn::Sub(hn::LoadU(d, f + i), mean));
      const Vec u = hn::Mul(weight, hn::Sub(hn::LoadU(d, gu + i), mean_u));
      const Vec v = hn::Mul(weight, hn::Sub(hn::LoadU(d, gv + i), mean_v));
      hn::StoreU(value, d, f + i), hn::StoreU(u, d, gu + i), hn::StoreU(v, d, gv + i);
      energy = add_product(energy, value, value);
      along_u = add_product(along_u, value, u);
      along_v = add_product(along_v, value, v);
    }
    sums.put(0, c, energy), sums.put(1, c, along_u), sums.put(2, c, along_v);
  }
  patch.energy = sums.collect(0);
  const float scale = 1.0F / std::max(patch.energy, 1e-6F);
  const Vec along_u = hn::Set(d, sums.collect(1) * scale);
  const Vec along_v = hn::Set(d, sums.collect(2) * scale);
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    Vec uu = hn::Zero(d), uv = uu, vv = uu;
    for (std::size_t i = c; i < end; i += kPatchStride) {
      const Vec value = hn::LoadU(d, f + i);
      const Vec u = hn::Sub(hn::LoadU(d, gu + i), hn::Mul(along_u, value));
      const Vec v = hn::Sub(hn::LoadU(d, gv + i), hn::Mul(along_v, value));
      hn::StoreU(u, d, gu + i), hn::StoreU(v, d, gv + i);
      uu = add_product(uu, u, u), uv = add_product(uv, u, v), vv = add_product(vv, v, v);
    }
    sums.put(0, c, uu), sums.put(1, c, uv), sums.put(2, c, vv);
  }
  patch.structure_uu = sums.collect(0);
  patch.structure_uv = sums.collect(1);
  patch.structure_vv = sums.collect(2);
}

PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch) {
  const Columns d;
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const TapVectors wu = broadcast(cubic_spline(u - floor_u));
  const TapVectors wv = broadcast(cubic_spline(v - floor_v));
  const Vec mean = hn::Set(d, patch.mean);
  ColumnSums<5> sums;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    const std::uint8_t* p = image.row(static_cast<int>(floor_v) - 1) + static_cast<int>(floor_u) - 1 + c;
    Vec s0 = hn::Zero(d), s1 = s0, s2 = s0;
    Vec gradient_u = s0, gradient_v = s0, value = s0, sum = s0, square = s0;
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
      }
      s0 = s1, s1 = s2, s2 = s3;
    }
    sums.put(0, c, gradient_u), sums.put(1, c, gradient_v), sums.put(2, c, value), sums.put(3, c, sum);
    sums.put(4, c, square);
  }
  return {sums.collect(0), sums.collect(1), sums.collect(2), sums.collect(3), sums.collect(4)};
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(sample_patch);
HWY_EXPORT(sample_warped_patch);
HWY_EXPORT(normalise);
HWY_EXPORT(compare_patch);

void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch) {
  HWY_DYNAMIC_DISPATCH(sample_patch)(image, u, v, patch);
}

void sample_warped_patch(const ImageView& image, float u, float v, const std::array<float, 4>& A,
                         PatchTemplate& patch) {
  HWY_DYNAMIC_DISPATCH(sample_warped_patch)(image, u, v, A, patch);
}

void normalise(PatchTemplate& patch) { HWY_DYNAMIC_DISPATCH(normalise)(patch); }

PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch) {
  return HWY_DYNAMIC_DISPATCH(compare_patch)(image, u, v, patch);
}

PatchFit fit_of(const PatchTemplate& patch, const PatchSums& sums) {
  const float spread = sums.square - sums.sum * sums.sum / patch.count;
  if (!(spread > kMinPatchContrast * patch.count && patch.energy > 0)) return {};
  return {spread, sums.value / std::sqrt(patch.energy * spread)};
}

}  // namespace pelorus
#endif
