// The part of patch.h that samples through a warp: in two passes where the warp is near the identity (patch_shear.h),
// else pixel by pixel. There positions and taps differ from pixel to pixel: floating point, in the reference's order of
// operations, rounded to units at the end.
#include <cstddef>
#include <cstring>

#include "core/kernels/patch.h"
#include "core/kernels/patch_shear.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/patch_warp.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#ifndef PELORUS_CORE_KERNELS_PATCH_WARP_ONCE
#define PELORUS_CORE_KERNELS_PATCH_WARP_ONCE
namespace pelorus {
inline constexpr float kSteepestUnits = 8000.0F;  // the sums' room, see patch-inl.h
}
#endif

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kPatchStride>;
using FloatVec = hn::VFromD<Floats>;
using Shorts = hn::Rebind<std::int16_t, Floats>;

struct FloatTaps {
  FloatVec w0, w1, w2, w3;
};

// No fused multiply-add: the same bits on every target (see the build's -ffp-contract=off).
HWY_INLINE FloatVec dot(const FloatTaps& w, FloatVec a, FloatVec b, FloatVec c, FloatVec e) {
  return hn::Add(hn::Add(hn::Mul(w.w0, a), hn::Mul(w.w1, b)), hn::Add(hn::Mul(w.w2, c), hn::Mul(w.w3, e)));
}

// Spline taps and their derivatives for a vector of fractions: the operations of cubic_spline.h.
HWY_INLINE FloatTaps spline_taps(FloatVec t) {
  const Floats d;
  const FloatVec s = hn::Sub(hn::Set(d, 1.0F), t);
  const FloatVec sixth = hn::Set(d, 1.0F / 6.0F);
  const FloatVec three = hn::Set(d, 3.0F), four = hn::Set(d, 4.0F), one = hn::Set(d, 1.0F);
  const FloatVec w1 = hn::Sub(four, hn::Mul(hn::Mul(hn::Mul(three, t), t), hn::Add(one, s)));
  const FloatVec w2 = hn::Sub(four, hn::Mul(hn::Mul(hn::Mul(three, s), s), hn::Add(one, t)));
  return {hn::Mul(hn::Mul(hn::Mul(s, s), s), sixth), hn::Mul(w1, sixth), hn::Mul(w2, sixth),
          hn::Mul(hn::Mul(hn::Mul(t, t), t), sixth)};
}

HWY_INLINE FloatTaps spline_derivatives(FloatVec t) {
  const Floats d;
  const FloatVec s = hn::Sub(hn::Set(d, 1.0F), t);
  const FloatVec half = hn::Set(d, 0.5F), more = hn::Set(d, 1.5F), two = hn::Set(d, 2.0F);
  return {hn::Mul(hn::Mul(hn::Neg(half), s), s), hn::Mul(t, hn::Sub(hn::Mul(more, t), two)),
          hn::Mul(s, hn::Sub(two, hn::Mul(more, s))), hn::Mul(hn::Mul(half, t), t)};
}

// Four neighbouring pixels per lane, as floats.
struct PixelQuads {
  FloatVec p0, p1, p2, p3;
};

// `first` + offset[lane] is each lane's first pixel. Plain loads: gather instructions are no faster for bytes.
HWY_INLINE PixelQuads load_quads(const std::uint8_t* first, const std::int32_t* offset) {
  const Floats d;
  const hn::RebindToUnsigned<Floats> du;
  const hn::RebindToSigned<Floats> di;
  alignas(64) std::uint32_t packed[kPatchStride];
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) std::memcpy(packed + lane, first + offset[lane], 4);
  const auto v = hn::Load(du, packed);
  const auto byte = hn::Set(du, 0xFF);
  const auto to_float = [&](auto x) HWY_ATTR { return hn::ConvertTo(d, hn::BitCast(di, hn::And(x, byte))); };
  return {to_float(v), to_float(hn::ShiftRight<8>(v)), to_float(hn::ShiftRight<16>(v)),
          to_float(hn::ShiftRight<24>(v))};
}

HWY_INLINE void store_units(FloatVec v, std::int16_t* out) {
  const Floats d;
  const FloatVec units = hn::Mul(v, hn::Set(d, static_cast<float>(kPatchUnits)));
  const FloatVec most = hn::Set(d, kSteepestUnits);
  const auto whole = hn::NearestInt(hn::Min(hn::Max(units, hn::Neg(most)), most));
  hn::StoreU(hn::DemoteTo(Shorts(), whole), Shorts(), out);
}

void sample_each_pixel(const ImageView& image, float u, float v, const std::array<float, 4>& A, PatchTemplate& patch) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const float center = 0.5F * static_cast<float>(patch.size - 1);
  const FloatVec zero = hn::Zero(d);
  const FloatVec last_u = hn::Set(d, static_cast<float>(image.width - 1));
  const FloatVec last_v = hn::Set(d, static_cast<float>(image.height - 1));
  const FloatVec a0 = hn::Set(d, A[0]), a1 = hn::Set(d, A[1]), a2 = hn::Set(d, A[2]), a3 = hn::Set(d, A[3]);
  const auto stride = static_cast<std::int32_t>(image.stride);
  const std::uint8_t* origin = image.pixels - stride - 1;
  for (int r = 0; r < patch.size; ++r) {
    const FloatVec y = hn::Set(d, static_cast<float>(r) - center);
    for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
      const FloatVec x = hn::Sub(hn::Iota(d, static_cast<float>(c)), hn::Set(d, center));
      const FloatVec wanted_u = hn::Add(hn::Set(d, u), hn::Add(hn::Mul(a0, x), hn::Mul(a1, y)));
      const FloatVec wanted_v = hn::Add(hn::Set(d, v), hn::Add(hn::Mul(a2, x), hn::Mul(a3, y)));
      const FloatVec pu = hn::Min(hn::Max(wanted_u, zero), last_u);
      const FloatVec pv = hn::Min(hn::Max(wanted_v, zero), last_v);
      const auto iu = hn::ConvertTo(di, pu);  // truncation: both are >= 0
      const auto iv = hn::ConvertTo(di, pv);
      const FloatVec fu = hn::Sub(pu, hn::ConvertTo(d, iu));
      const FloatVec fv = hn::Sub(pv, hn::ConvertTo(d, iv));
      alignas(64) std::int32_t offset[kPatchStride];
      hn::Store(hn::Add(hn::Mul(iv, hn::Set(di, stride)), iu), di, offset);
      const FloatTaps wu = spline_taps(fu), du = spline_derivatives(fu);
      FloatVec rows[4], slopes[4];
      for (int k = 0; k < 4; ++k) {
        const PixelQuads q = load_quads(origin + k * image.stride, offset);
        rows[k] = dot(wu, q.p0, q.p1, q.p2, q.p3);
        slopes[k] = dot(du, q.p0, q.p1, q.p2, q.p3);
      }
      const FloatTaps wv = spline_taps(fv), dv = spline_derivatives(fv);
      const FloatVec gu = dot(wv, slopes[0], slopes[1], slopes[2], slopes[3]);
      const FloatVec gv = dot(dv, rows[0], rows[1], rows[2], rows[3]);
      const std::size_t i = static_cast<std::size_t>(r) * kPatchStride + c;
      store_units(dot(wv, rows[0], rows[1], rows[2], rows[3]), patch.value.data() + i);
      store_units(hn::Add(hn::Mul(gu, a0), hn::Mul(gv, a2)), patch.gradient_u.data() + i);
      store_units(hn::Add(hn::Mul(gu, a1), hn::Mul(gv, a3)), patch.gradient_v.data() + i);
      const auto shown = hn::VecFromMask(d, hn::And(hn::Eq(pu, wanted_u), hn::Eq(pv, wanted_v)));
      std::int16_t* mask = patch.mask.data() + i;
      hn::StoreU(hn::And(hn::DemoteTo(Shorts(), hn::BitCast(di, shown)), hn::LoadU(Shorts(), mask)), Shorts(), mask);
    }
  }
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(sample_each_pixel);

void sample_warped_patch(const ImageView& image, float u, float v, const std::array<float, 4>& A,
                         PatchTemplate& patch) {
  shear::Plan plan;
  if (shear::make_plan(image, u, v, A, patch.size, plan)) return sample_sheared(image, plan, patch);
  HWY_DYNAMIC_DISPATCH(sample_each_pixel)(image, u, v, A, patch);
}

}  // namespace pelorus
#endif
