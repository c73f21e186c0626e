// The fast part of sample_warped_patch(): see patch_shear.h.
#include "core/kernels/patch_shear.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/patch_shear.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
// After highway.h, which sets the target.
#include "core/kernels/patch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // has no byte shuffles
void sample_sheared(const ImageView& image, const shear::Plan& plan, PatchTemplate& patch) {
  reference::sample_sheared(image, plan, patch);
}
#else

struct SplineAndSlope {
  TapVectors w;
  TapVectors d;
};

// Taps of the cubic B-spline and of its derivative for fractions of 2^15; the operations of reference::taps_at().
HWY_INLINE SplineAndSlope taps_at(Vec t) {
  const Columns d;
  const auto set = [](int x) HWY_ATTR { return hn::Set(Columns(), static_cast<std::int16_t>(x)); };
  const Vec s = hn::Sub(set(32767), t);
  const Vec t2 = hn::MulFixedPoint15(t, t), s2 = hn::MulFixedPoint15(s, s);
  const Vec t3 = hn::MulFixedPoint15(t2, t), s3 = hn::MulFixedPoint15(s2, s);
  const Vec half_t2 = hn::ShiftRight<1>(t2);
  const Vec w0 = hn::MulFixedPoint15(s3, set(5461)), w3 = hn::MulFixedPoint15(t3, set(5461));
  const Vec w1 = hn::Add(hn::Sub(set(21845), t2), hn::ShiftRight<1>(t3));
  const Vec w2 = hn::Sub(hn::Sub(set(32767), w1), hn::Add(w0, w3));
  const Vec d0 = hn::Sub(hn::Zero(d), hn::ShiftRight<1>(s2));
  const Vec d1 = hn::Sub(hn::Add(t2, half_t2), hn::Add(t, t));
  const Vec d2 = hn::Sub(hn::Sub(hn::Zero(d), hn::Add(d0, d1)), half_t2);
  return {{w0, w1, w2, w3}, {d0, d1, d2, half_t2}};
}

// Positions base + progression, split again into whole and fraction.
struct Split {
  Vec whole;
  Vec part;
};
HWY_INLINE Split add_base(const shear::Progression& progression, std::size_t c, int base) {
  const Columns d;
  const hn::RebindToUnsigned<Columns> du;
  const Vec sum = hn::Add(hn::LoadU(d, progression.part.data() + c),
                          hn::Set(d, static_cast<std::int16_t>(base & (shear::kOne - 1))));
  const Vec carry = hn::BitCast(d, hn::ShiftRight<15>(hn::BitCast(du, sum)));
  const Vec whole =
      hn::Add(hn::LoadU(d, progression.whole.data() + c), hn::Set(d, static_cast<std::int16_t>(base >> 15)));
  return {hn::Add(whole, carry), hn::And(sum, hn::Set(d, std::int16_t{32767}))};
}

// Sixteen bytes for every eight columns, from the first byte that each eight of them need.
HWY_INLINE hn::VFromD<hn::Repartition<std::uint8_t, Columns> > load_blocks(const std::uint8_t* row, int first,
                                                                           int second) {
  const hn::Repartition<std::uint8_t, Columns> d8;
#if HWY_TARGET <= HWY_AVX2
  const hn::Half<decltype(d8)> half;
  return hn::Combine(d8, hn::LoadU(half, row + second), hn::LoadU(half, row + first));
#else
  static_cast<void>(second);
  return hn::LoadU(d8, row + first);
#endif
}

// One row of the image through the spline along it, and its slope.
HWY_INLINE void filter_along(const shear::Plan& plan, const std::uint8_t* row, int base, std::size_t c,
                             std::int16_t* value, std::int16_t* slope) {
  const Columns d;
  const hn::Repartition<std::uint8_t, Columns> d8;
  const hn::RebindToUnsigned<Columns> du;
  const Split at = add_base(plan.along, c, base);
  const int first = (base + static_cast<int>(c) * plan.step) >> 15;
  const int second = (base + static_cast<int>(c + 8) * plan.step) >> 15;
  // Index of each column's first byte within its block, in the high byte; the low one reads as zero: a grey level
  // times 256.
#if HWY_TARGET <= HWY_AVX2
  const hn::Half<Columns> half;
  const Vec origin =
      hn::Combine(d, hn::Set(half, static_cast<std::int16_t>(second)), hn::Set(half, static_cast<std::int16_t>(first)));
#else
  const Vec origin = hn::Set(d, static_cast<std::int16_t>(first));
#endif
  const auto blocks = load_blocks(row - 1, first, second);
  const auto index = hn::Or(hn::ShiftLeft<8>(hn::Sub(at.whole, origin)), hn::Set(d, std::int16_t{0x80}));
  const auto pixel = [&](int k) HWY_ATTR {
    const auto from = hn::BitCast(d8, hn::Add(index, hn::Set(d, static_cast<std::int16_t>(k << 8))));
    const auto wide = hn::BitCast(du, hn::TableLookupBytesOr0(blocks, from));
    return hn::BitCast(d, hn::ShiftRight<1>(wide));
  };
  const Vec a = pixel(0), b = pixel(1), e = pixel(2), f = pixel(3);
  const SplineAndSlope taps = taps_at(at.part);
  hn::StoreU(dot(taps.w, a, b, e, f), d, value);
  hn::StoreU(dot(taps.d, a, b, e, f), d, slope);
}

// Weights of the rows from the first that any column needs on; each column has its four taps from its own row on.
template <int kRowsHit>
HWY_INLINE void spread(const TapVectors& taps, Vec row, Vec (&weight)[kRowsHit + 3]) {
  const Columns d;
  const Vec tap[4] = {taps.w0, taps.w1, taps.w2, taps.w3};
  for (Vec& w : weight) w = hn::Zero(d);
  for (int hit = 0; hit < kRowsHit; ++hit) {
    const Vec here = hn::VecFromMask(d, hn::Eq(row, hn::Set(d, static_cast<std::int16_t>(hit))));
    for (int k = 0; k < 4; ++k) weight[hit + k] = hn::Or(weight[hit + k], hn::And(here, tap[k]));
  }
}

// One row of the patch from filtered rows of the image; `first` is the first row that any of its columns falls on.
template <int kRowsHit>
HWY_INLINE void filter_down(const shear::Plan& plan, const shear::Rows& values, const shear::Rows& slopes, int base,
                            int first, std::size_t c, std::size_t out, PatchTemplate& patch) {
  const Columns d;
  const Split at = add_base(plan.down, c, base);
  const SplineAndSlope taps = taps_at(at.part);
  const Vec row = hn::Sub(at.whole, hn::Set(d, static_cast<std::int16_t>(first)));
  Vec w[kRowsHit + 3], s[kRowsHit + 3];
  if constexpr (kRowsHit == 1) {
    w[0] = taps.w.w0, w[1] = taps.w.w1, w[2] = taps.w.w2, w[3] = taps.w.w3;
    s[0] = taps.d.w0, s[1] = taps.d.w1, s[2] = taps.d.w2, s[3] = taps.d.w3;
  } else {
    spread<kRowsHit>(taps.w, row, w);
    spread<kRowsHit>(taps.d, row, s);
  }
  Vec value = hn::Zero(d), across = value, along = value;
  for (int j = 0; j < kRowsHit + 3; ++j) {
    const std::size_t i = static_cast<std::size_t>(first + j) * kPatchStride + c;
    const Vec f = hn::LoadU(d, values.data() + i);
    value = hn::Add(value, hn::MulFixedPoint15(f, w[j]));
    along = hn::Add(along, hn::MulFixedPoint15(hn::LoadU(d, slopes.data() + i), w[j]));
    across = hn::Add(across, hn::MulFixedPoint15(f, s[j]));
  }
  const auto halved = [&](Vec g, std::int16_t factor) HWY_ATTR { return hn::MulFixedPoint15(g, hn::Set(d, factor)); };
  const auto units = [&](Vec half) HWY_ATTR { return hn::ShiftRight<1>(hn::Add(half, hn::Set(d, std::int16_t{1}))); };
  hn::StoreU(to_units(value), d, patch.value.data() + out);
  hn::StoreU(units(hn::Add(halved(along, plan.half_step), halved(across, plan.half_slope))), d,
             patch.gradient_u.data() + out);
  hn::StoreU(units(halved(across, plan.half_height)), d, patch.gradient_v.data() + out);
}

void sample_sheared(const ImageView& image, const shear::Plan& plan, PatchTemplate& patch) {
  const Columns d;
  alignas(64) shear::Rows values;
  alignas(64) shear::Rows slopes;
  for (std::size_t c = 0; c < kPatchStride; c += hn::Lanes(d)) {
    const std::uint8_t* row = image.row(plan.first_row) + plan.first_column;
    for (int r = 0; r < plan.rows; ++r, row += image.stride) {
      const std::size_t i = static_cast<std::size_t>(r) * kPatchStride + c;
      filter_along(plan, row, plan.column_at(r), c, values.data() + i, slopes.data() + i);
    }
    for (int y = 0; y < plan.size; ++y) {
      const std::size_t out = static_cast<std::size_t>(y) * kPatchStride + c;
      const shear::RowsHit hit = shear::rows_hit(plan, y);
      if (hit.count == 1) {
        filter_down<1>(plan, values, slopes, plan.row_at(y), hit.first, c, out, patch);
      } else if (hit.count == 2) {
        filter_down<2>(plan, values, slopes, plan.row_at(y), hit.first, c, out, patch);
      } else {
        filter_down<3>(plan, values, slopes, plan.row_at(y), hit.first, c, out, patch);
      }
    }
  }
}
#endif  // HWY_SCALAR

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(sample_sheared);

void sample_sheared(const ImageView& image, const shear::Plan& plan, PatchTemplate& patch) {
  HWY_DYNAMIC_DISPATCH(sample_sheared)(image, plan, patch);
}

namespace reference {
namespace {

int product(int a, int b) { return (a * b + (1 << 14)) >> 15; }

struct Taps {
  std::array<int, 4> w;
  std::array<int, 4> d;
};
Taps taps_at(int t) {
  const int s = 32767 - t;
  const int t2 = product(t, t), s2 = product(s, s);
  const int t3 = product(t2, t), s3 = product(s2, s);
  const int w0 = product(s3, 5461), w3 = product(t3, 5461);
  const int w1 = 21845 - t2 + (t3 >> 1);
  const int d0 = -(s2 >> 1), d1 = t2 + (t2 >> 1) - 2 * t, d3 = t2 >> 1;
  return {{w0, w1, 32767 - w1 - w0 - w3, w3}, {d0, d1, -(d0 + d1) - d3, d3}};
}

int dot(const std::array<int, 4>& w, const std::array<int, 4>& x) {
  return product(w[0], x[0]) + product(w[1], x[1]) + product(w[2], x[2]) + product(w[3], x[3]);
}

std::size_t index_of(int row, int column) { return static_cast<std::size_t>(row * kPatchStride + column); }

void filter_along(const ImageView& image, const shear::Plan& plan, shear::Rows& values, shear::Rows& slopes) {
  for (int r = 0; r < plan.rows; ++r) {
    for (int c = 0; c < plan.size; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const int at = plan.column_at(r) + plan.along.whole[k] * shear::kOne + plan.along.part[k];
      const std::uint8_t* p = image.row(plan.first_row + r) + plan.first_column + (at >> 15) - 1;
      const std::array<int, 4> pixels{p[0] << 7, p[1] << 7, p[2] << 7, p[3] << 7};
      const Taps taps = taps_at(at & (shear::kOne - 1));
      values[index_of(r, c)] = static_cast<std::int16_t>(dot(taps.w, pixels));
      slopes[index_of(r, c)] = static_cast<std::int16_t>(dot(taps.d, pixels));
    }
  }
}

}  // namespace

void sample_sheared(const ImageView& image, const shear::Plan& plan, PatchTemplate& patch) {
  shear::Rows values{};
  shear::Rows slopes{};
  filter_along(image, plan, values, slopes);
  for (int y = 0; y < plan.size; ++y) {
    for (int c = 0; c < plan.size; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const int at = plan.row_at(y) + plan.down.whole[k] * shear::kOne + plan.down.part[k];
      const Taps taps = taps_at(at & (shear::kOne - 1));
      std::array<int, 4> f{}, g{};
      for (int j = 0; j < 4; ++j) {
        f[static_cast<std::size_t>(j)] = values[index_of((at >> 15) + j, c)];
        g[static_cast<std::size_t>(j)] = slopes[index_of((at >> 15) + j, c)];
      }
      const int along = dot(taps.w, g), across = dot(taps.d, f);
      const int gu = product(along, plan.half_step) + product(across, plan.half_slope);
      const int gv = product(across, plan.half_height);
      patch.value[index_of(y, c)] = static_cast<std::int16_t>((dot(taps.w, f) + 2) >> 2);
      patch.gradient_u[index_of(y, c)] = static_cast<std::int16_t>((gu + 1) >> 1);
      patch.gradient_v[index_of(y, c)] = static_cast<std::int16_t>((gv + 1) >> 1);
    }
  }
}

}  // namespace reference
}  // namespace pelorus
#endif
