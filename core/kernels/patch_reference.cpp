// Scalar twins of patch*.cpp: the same integers by the plainest code, for tests and for reading.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/kernels/cubic_spline.h"
#include "core/kernels/patch.h"
#include "core/kernels/patch_shear.h"
#include "core/kernels/patch_totals.h"

namespace pelorus::reference {
namespace {

using FixedTaps = std::array<std::int16_t, 4>;
using Taps = std::array<float, 4>;

// Products rounded to nearest fraction of 2^15.
int dot(const FixedTaps& w, const std::array<int, 4>& x) {
  int sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += (w[i] * x[i] + (1 << 14)) >> 15;
  return sum;
}

// One pixel through the spline, in units; `first` is the top left of its 4x4 neighbourhood.
std::int16_t value_at(const std::uint8_t* first, std::ptrdiff_t stride, const FixedTaps& wu, const FixedTaps& wv) {
  std::array<int, 4> rows{};
  for (std::size_t r = 0; r < 4; ++r) {
    const std::uint8_t* p = first + static_cast<std::ptrdiff_t>(r) * stride;
    rows[r] = dot(wu, {p[0] << 7, p[1] << 7, p[2] << 7, p[3] << 7});
  }
  return static_cast<std::int16_t>((dot(wv, rows) + 2) >> 2);
}

float dot(const Taps& w, const Taps& x) { return (w[0] * x[0] + w[1] * x[1]) + (w[2] * x[2] + w[3] * x[3]); }

float value_at(const std::uint8_t* first, std::ptrdiff_t stride, const Taps& wu, const Taps& wv) {
  Taps rows{};
  for (std::size_t r = 0; r < 4; ++r) {
    const std::uint8_t* p = first + static_cast<std::ptrdiff_t>(r) * stride;
    rows[r] = dot(
        wu, {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), static_cast<float>(p[3])});
  }
  return dot(wv, rows);
}

std::int16_t to_units(float grey) {
  return static_cast<std::int16_t>(std::lrint(std::clamp(grey * static_cast<float>(kPatchUnits), -8000.0F, 8000.0F)));
}

std::size_t index_of(int row, int column) { return static_cast<std::size_t>(row * kPatchStride + column); }

template <class F>
std::int64_t sum_of(int size, F&& term) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < index_of(size, 0); ++i) sum += term(i);
  return sum;
}

// The patch at (u, v) relative to the template's mean; 0 where the mask is.
PatchRows relative_patch(const ImageView& image, float u, float v, const PatchTemplate& patch) {
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const FixedTaps wu = fixed_taps(cubic_spline(u - floor_u));
  const FixedTaps wv = fixed_taps(cubic_spline(v - floor_v));
  PatchRows relative{};
  for (int r = 0; r < patch.size; ++r) {
    for (int c = 0; c < kPatchStride; ++c) {
      const std::uint8_t* first = image.row(static_cast<int>(floor_v) + r - 1) + static_cast<int>(floor_u) + c - 1;
      const std::size_t i = index_of(r, c);
      const int value = value_at(first, image.stride, wu, wv) - patch.mean;
      relative[i] = static_cast<std::int16_t>(patch.mask[i] != 0 ? value : 0);
    }
  }
  return relative;
}

ComparisonTotals compare(const PatchRows& relative, const PatchTemplate& patch) {
  ComparisonTotals totals;
  totals.u = sum_of(patch.size, [&](std::size_t i) { return patch.gradient_u[i] * relative[i]; });
  totals.v = sum_of(patch.size, [&](std::size_t i) { return patch.gradient_v[i] * relative[i]; });
  totals.value = sum_of(patch.size, [&](std::size_t i) { return patch.value[i] * relative[i]; });
  totals.sum = sum_of(patch.size, [&](std::size_t i) { return relative[i]; });
  totals.square = sum_of(patch.size, [&](std::size_t i) { return relative[i] * relative[i]; });
  return totals;
}

}  // namespace

void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch) {
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const FixedTaps wu = fixed_taps(cubic_spline(u - floor_u));
  const FixedTaps du = fixed_taps(cubic_spline_derivative(u - floor_u));
  const FixedTaps wv = fixed_taps(cubic_spline(v - floor_v));
  const FixedTaps dv = fixed_taps(cubic_spline_derivative(v - floor_v));
  for (int r = 0; r < patch.size; ++r) {
    for (int c = 0; c < kPatchStride; ++c) {
      const std::uint8_t* first = image.row(static_cast<int>(floor_v) + r - 1) + static_cast<int>(floor_u) + c - 1;
      patch.value[index_of(r, c)] = value_at(first, image.stride, wu, wv);
      patch.gradient_u[index_of(r, c)] = value_at(first, image.stride, du, wv);
      patch.gradient_v[index_of(r, c)] = value_at(first, image.stride, wu, dv);
    }
  }
}

void sample_warped_patch(const ImageView& image, float u, float v, const std::array<float, 4>& A,
                         PatchTemplate& patch) {
  shear::Plan plan;
  if (shear::make_plan(image, u, v, A, patch.size, plan)) return reference::sample_sheared(image, plan, patch);
  reference::sample_each_pixel(image, u, v, A, patch);
}

void sample_each_pixel(const ImageView& image, float u, float v, const std::array<float, 4>& A, PatchTemplate& patch) {
  const float center = 0.5F * static_cast<float>(patch.size - 1);
  const auto last_u = static_cast<float>(image.width - 1);
  const auto last_v = static_cast<float>(image.height - 1);
  for (int r = 0; r < patch.size; ++r) {
    for (int c = 0; c < kPatchStride; ++c) {
      const float x = static_cast<float>(c) - center;
      const float y = static_cast<float>(r) - center;
      const float wanted_u = u + (A[0] * x + A[1] * y);
      const float wanted_v = v + (A[2] * x + A[3] * y);
      const float pu = std::clamp(wanted_u, 0.0F, last_u);
      const float pv = std::clamp(wanted_v, 0.0F, last_v);
      const float floor_u = std::floor(pu);
      const float floor_v = std::floor(pv);
      const std::uint8_t* first = image.row(static_cast<int>(floor_v) - 1) + static_cast<int>(floor_u) - 1;
      const Taps wu = cubic_spline(pu - floor_u);
      const Taps du = cubic_spline_derivative(pu - floor_u);
      const Taps wv = cubic_spline(pv - floor_v);
      const Taps dv = cubic_spline_derivative(pv - floor_v);
      const float gu = value_at(first, image.stride, du, wv);
      const float gv = value_at(first, image.stride, wu, dv);
      const std::size_t i = index_of(r, c);
      patch.value[i] = to_units(value_at(first, image.stride, wu, wv));
      patch.gradient_u[i] = to_units(gu * A[0] + gv * A[2]);
      patch.gradient_v[i] = to_units(gu * A[1] + gv * A[3]);
      if (pu != wanted_u || pv != wanted_v) patch.mask[i] = 0;
    }
  }
}

void normalise(PatchTemplate& patch) {
  auto& f = patch.value;
  auto& gu = patch.gradient_u;
  auto& gv = patch.gradient_v;
  TemplateTotals totals;
  totals.count = sum_of(patch.size, [&](std::size_t i) { return -patch.mask[i]; });
  patch.mean = rounded_mean(sum_of(patch.size, [&](std::size_t i) { return -patch.mask[i] * f[i]; }), totals.count);
  for (std::size_t i = 0; i < index_of(patch.size, 0); ++i) {
    f[i] = static_cast<std::int16_t>(-patch.mask[i] * (f[i] - patch.mean));
    gu[i] = static_cast<std::int16_t>(-patch.mask[i] * gu[i]);
    gv[i] = static_cast<std::int16_t>(-patch.mask[i] * gv[i]);
  }
  const auto product = [&](const PatchRows& a, const PatchRows& b) {
    return sum_of(patch.size, [&](std::size_t i) { return a[i] * b[i]; });
  };
  const auto sum = [&](const PatchRows& a) { return sum_of(patch.size, [&](std::size_t i) { return a[i]; }); };
  totals.value = sum(f), totals.u = sum(gu), totals.v = sum(gv);
  totals.value_value = product(f, f), totals.value_u = product(f, gu), totals.value_v = product(f, gv);
  totals.u_u = product(gu, gu), totals.u_v = product(gu, gv), totals.v_v = product(gv, gv);
  finish(totals, patch);
}

void prepare_slant(const PatchTemplate& patch, PatchSlant& slant) {
  const int center = (patch.size - 1) / 2;
  auto& sx = slant.slope_x;
  auto& sy = slant.slope_y;
  const auto& f = patch.value;
  const auto& g = patch.gradient_u;
  constexpr int kRatio = kPatchUnits / PatchSlant::kUnits;
  const auto slope = [](int gradient, int offset) {
    return static_cast<std::int16_t>((2 * gradient * offset + kRatio) >> 4);
  };
  for (int r = 0; r < patch.size; ++r) {
    for (int c = 0; c < kPatchStride; ++c) {
      sx[index_of(r, c)] = slope(g[index_of(r, c)], std::min(c - center, center));
      sy[index_of(r, c)] = slope(g[index_of(r, c)], r - center);
    }
  }
  const auto product = [&](const PatchRows& a, const PatchRows& b) {
    return sum_of(patch.size, [&](std::size_t i) { return a[i] * b[i]; });
  };
  SlantTotals totals;
  totals.x = sum_of(patch.size, [&](std::size_t i) { return sx[i]; });
  totals.y = sum_of(patch.size, [&](std::size_t i) { return sy[i]; });
  totals.value_x = product(f, sx), totals.value_y = product(f, sy);
  totals.u_x = product(g, sx), totals.u_y = product(g, sy);
  totals.x_x = product(sx, sx), totals.x_y = product(sx, sy), totals.y_y = product(sy, sy);
  finish(totals, patch, slant);
}

SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                const PatchSlant& slant) {
  const PatchRows relative = relative_patch(image, u, v, patch);
  SlantComparisonTotals totals;
  totals.plain = compare(relative, patch);
  totals.x = sum_of(patch.size, [&](std::size_t i) { return slant.slope_x[i] * relative[i]; });
  totals.y = sum_of(patch.size, [&](std::size_t i) { return slant.slope_y[i] * relative[i]; });
  return finish(totals, patch, slant);
}

PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch) {
  return finish(compare(relative_patch(image, u, v, patch), patch), patch);
}

}  // namespace pelorus::reference
