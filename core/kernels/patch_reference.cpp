// Scalar twins of patch.cpp: the same operations in the same order, for tests and for reading.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/kernels/cubic_spline.h"
#include "core/kernels/patch.h"

namespace pelorus::reference {
namespace {

using Taps = std::array<float, 4>;

float dot(const Taps& w, const std::uint8_t* p) {
  return (w[0] * static_cast<float>(p[0]) + w[1] * static_cast<float>(p[1])) +
         (w[2] * static_cast<float>(p[2]) + w[3] * static_cast<float>(p[3]));
}

float dot(const Taps& w, const Taps& x) { return (w[0] * x[0] + w[1] * x[1]) + (w[2] * x[2] + w[3] * x[3]); }

// One pixel through the spline; `first` is the top left of its 4x4 neighbourhood.
float value_at(const std::uint8_t* first, std::ptrdiff_t stride, const Taps& wu, const Taps& wv) {
  Taps rows{};
  for (std::size_t r = 0; r < 4; ++r) rows[r] = dot(wu, first + static_cast<std::ptrdiff_t>(r) * stride);
  return dot(wv, rows);
}

std::size_t index_of(int row, int column) { return static_cast<std::size_t>(row * kPatchStride + column); }

// Sum over rows per column, then columns in halves: the order of the vector code.
template <class F>
float sum_of(int size, F&& term) {
  std::array<float, kPatchStride> columns{};
  for (int r = 0; r < size; ++r) {
    for (int c = 0; c < kPatchStride; ++c) columns[static_cast<std::size_t>(c)] += term(index_of(r, c));
  }
  for (std::size_t half = kPatchStride / 2; half > 0; half /= 2) {
    for (std::size_t c = 0; c < half; ++c) columns[c] += columns[c + half];
  }
  return columns[0];
}

// The patch at (u, v) relative to the template's mean; 0 where the weight is.
PatchRows relative_patch(const ImageView& image, float u, float v, const PatchTemplate& patch) {
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const Taps wu = cubic_spline(u - floor_u);
  const Taps wv = cubic_spline(v - floor_v);
  PatchRows relative{};
  for (int r = 0; r < patch.size; ++r) {
    for (int c = 0; c < kPatchStride; ++c) {
      const std::uint8_t* first = image.row(static_cast<int>(floor_v) + r - 1) + static_cast<int>(floor_u) + c - 1;
      const std::size_t i = index_of(r, c);
      relative[i] = patch.weight[i] * (value_at(first, image.stride, wu, wv) - patch.mean);
    }
  }
  return relative;
}

PatchSums compare(const PatchRows& relative, const PatchTemplate& patch) {
  PatchSums sums;
  sums.gradient_u = sum_of(patch.size, [&](std::size_t i) { return patch.gradient_u[i] * relative[i]; });
  sums.gradient_v = sum_of(patch.size, [&](std::size_t i) { return patch.gradient_v[i] * relative[i]; });
  sums.value = sum_of(patch.size, [&](std::size_t i) { return patch.value[i] * relative[i]; });
  sums.sum = sum_of(patch.size, [&](std::size_t i) { return relative[i]; });
  sums.square = sum_of(patch.size, [&](std::size_t i) { return relative[i] * relative[i]; });
  return sums;
}

}  // namespace

void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch) {
  const float floor_u = std::floor(u);
  const float floor_v = std::floor(v);
  const Taps wu = cubic_spline(u - floor_u);
  const Taps du = cubic_spline_derivative(u - floor_u);
  const Taps wv = cubic_spline(v - floor_v);
  const Taps dv = cubic_spline_derivative(v - floor_v);
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
      patch.value[i] = value_at(first, image.stride, wu, wv);
      patch.gradient_u[i] = gu * A[0] + gv * A[2];
      patch.gradient_v[i] = gu * A[1] + gv * A[3];
      if (pu != wanted_u || pv != wanted_v) patch.weight[i] = 0;
    }
  }
}

void normalise(PatchTemplate& patch) {
  const auto& w = patch.weight;
  auto& f = patch.value;
  auto& gu = patch.gradient_u;
  auto& gv = patch.gradient_v;
  patch.count = sum_of(patch.size, [&](std::size_t i) { return w[i]; });
  const float per_pixel = 1.0F / std::max(patch.count, 1.0F);
  patch.mean = sum_of(patch.size, [&](std::size_t i) { return w[i] * f[i]; }) * per_pixel;
  const float mean_u = sum_of(patch.size, [&](std::size_t i) { return w[i] * gu[i]; }) * per_pixel;
  const float mean_v = sum_of(patch.size, [&](std::size_t i) { return w[i] * gv[i]; }) * per_pixel;
  const std::size_t end = index_of(patch.size, 0);
  for (std::size_t i = 0; i < end; ++i) {
    f[i] = w[i] * (f[i] - patch.mean);
    gu[i] = w[i] * (gu[i] - mean_u);
    gv[i] = w[i] * (gv[i] - mean_v);
  }
  patch.energy = sum_of(patch.size, [&](std::size_t i) { return f[i] * f[i]; });
  const float scale = 1.0F / std::max(patch.energy, 1e-6F);
  const float along_u = sum_of(patch.size, [&](std::size_t i) { return f[i] * gu[i]; }) * scale;
  const float along_v = sum_of(patch.size, [&](std::size_t i) { return f[i] * gv[i]; }) * scale;
  for (std::size_t i = 0; i < end; ++i) {
    gu[i] = gu[i] - along_u * f[i];
    gv[i] = gv[i] - along_v * f[i];
  }
  patch.structure_uu = sum_of(patch.size, [&](std::size_t i) { return gu[i] * gu[i]; });
  patch.structure_uv = sum_of(patch.size, [&](std::size_t i) { return gu[i] * gv[i]; });
  patch.structure_vv = sum_of(patch.size, [&](std::size_t i) { return gv[i] * gv[i]; });
}

void prepare_slant(const PatchTemplate& patch, PatchSlant& slant) {
  const float center = 0.5F * static_cast<float>(patch.size - 1);
  auto& sx = slant.slope_x;
  auto& sy = slant.slope_y;
  const auto& f = patch.value;
  const auto& g = patch.gradient_u;
  const auto& w = patch.weight;
  for (int r = 0; r < patch.size; ++r) {
    for (int c = 0; c < kPatchStride; ++c) {
      sx[index_of(r, c)] = g[index_of(r, c)] * (static_cast<float>(c) - center);
      sy[index_of(r, c)] = g[index_of(r, c)] * (static_cast<float>(r) - center);
    }
  }
  const float per_pixel = 1.0F / std::max(patch.count, 1.0F);
  const float scale = 1.0F / std::max(patch.energy, 1e-6F);
  const float mean_x = sum_of(patch.size, [&](std::size_t i) { return w[i] * sx[i]; }) * per_pixel;
  const float mean_y = sum_of(patch.size, [&](std::size_t i) { return w[i] * sy[i]; }) * per_pixel;
  const float along_x = sum_of(patch.size, [&](std::size_t i) { return f[i] * sx[i]; }) * scale;
  const float along_y = sum_of(patch.size, [&](std::size_t i) { return f[i] * sy[i]; }) * scale;
  for (std::size_t i = 0; i < index_of(patch.size, 0); ++i) {
    sx[i] = w[i] * (sx[i] - mean_x) - along_x * f[i];
    sy[i] = w[i] * (sy[i] - mean_y) - along_y * f[i];
  }
  slant.structure = {patch.structure_uu,
                     sum_of(patch.size, [&](std::size_t i) { return g[i] * sx[i]; }),
                     sum_of(patch.size, [&](std::size_t i) { return g[i] * sy[i]; }),
                     sum_of(patch.size, [&](std::size_t i) { return sx[i] * sx[i]; }),
                     sum_of(patch.size, [&](std::size_t i) { return sx[i] * sy[i]; }),
                     sum_of(patch.size, [&](std::size_t i) { return sy[i] * sy[i]; })};
}

SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                const PatchSlant& slant) {
  const PatchRows relative = relative_patch(image, u, v, patch);
  return {compare(relative, patch), sum_of(patch.size, [&](std::size_t i) { return slant.slope_x[i] * relative[i]; }),
          sum_of(patch.size, [&](std::size_t i) { return slant.slope_y[i] * relative[i]; })};
}

PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch) {
  return compare(relative_patch(image, u, v, patch), patch);
}

}  // namespace pelorus::reference
