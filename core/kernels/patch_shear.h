#pragma once
// Plan of sampling a patch through a warp near the identity in two passes: along the rows of the image, then down the
// columns of the patch (two-pass resampling of Catmull & Smith 1980), in 16-bit fixed point. Each source row r is read
// at X_r(i) = X_r(0) + step * i, the value at column i and row y is the spline over the rows r about
// Y_y(i) = Y_y(0) + slope * i. Shared by the vector and the scalar path of patch_warp.cpp; not for callers. Pure.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/base/image.h"
#include "core/kernels/patch.h"

namespace pelorus::shear {

inline constexpr int kOne = 1 << 15;
inline constexpr int kMaxRows = 32;  // of the image under a patch
using Rows = std::array<std::int16_t, kMaxRows * kPatchStride>;

// Whole and fractional part of k * step for the columns k, fractions of 2^15.
struct Progression {
  alignas(32) std::array<std::int16_t, kPatchStride> whole;
  alignas(32) std::array<std::int16_t, kPatchStride> part;

  explicit Progression(int step = 0) {
    for (int k = 0; k < kPatchStride; ++k) {
      const auto i = static_cast<std::size_t>(k);
      whole[i] = static_cast<std::int16_t>((k * step) >> 15);
      part[i] = static_cast<std::int16_t>((k * step) & (kOne - 1));
    }
  }
};

struct Plan {
  int first_row = 0;     // of the image
  int rows = 0;          // as many are read
  int first_column = 0;  // of the image; positions along a row count from here
  int size = 0;
  // Fractions of 2^15: X_r(0) = column_base + (r - first_row) * column_per_row, Y_y(0) = row_base + y * row_per_row,
  // the latter counted from first_row + 1.
  int column_base = 0;
  int column_per_row = 0;
  int step = 0;
  int row_base = 0;
  int row_per_row = 0;
  int row_slope = 0;
  Progression along;  // of X over the columns
  Progression down;   // of Y over the columns
  // Gradients along the patch's axes from those along row and column, halved to fit a fraction of 2^15.
  std::int16_t half_step = 0;
  std::int16_t half_slope = 0;
  std::int16_t half_height = 0;

  [[nodiscard]] int column_at(int row) const { return column_base + row * column_per_row; }
  [[nodiscard]] int row_at(int y) const { return row_base + y * row_per_row; }
};

inline int fixed(float x) { return static_cast<int>(x * static_cast<float>(kOne) + (x < 0 ? -0.5F : 0.5F)); }

// Rows (counted as Plan::row_at) that the columns of row y of the patch fall on.
struct RowsHit {
  int first = 0;
  int count = 0;
};
inline RowsHit rows_hit(const Plan& plan, int y) {
  const int left = plan.row_at(y) >> 15;
  const int right = (plan.row_at(y) + (plan.size - 1) * plan.row_slope) >> 15;
  return {std::min(left, right), std::abs(left - right) + 1};
}

// False when the warp is too far from the identity for two passes and 16 bits, or the patch leaves the image.
inline bool make_plan(const ImageView& image, float u, float v, const std::array<float, 4>& A, int size, Plan& plan) {
  const float center = 0.5F * static_cast<float>(size - 1);
  if (!(std::abs(A[3] - 1) <= 0.3F && std::abs(A[2]) * 2 * center <= 1.9F)) return false;
  const float slant = A[1] / A[3];  // columns per row of the image
  const float step = A[0] - slant * A[2];
  if (!(std::abs(slant) <= 0.4F && step >= 0.7F && step + std::abs(A[2]) <= 1.3F)) return false;
  const float reach_u = center * (std::abs(A[0]) + std::abs(A[1]));
  const float reach_v = center * (std::abs(A[2]) + std::abs(A[3])) + 0.01F;  // rounding of the plan may add a row
  if (!(u - reach_u >= 0 && v - reach_v >= 0 && u + reach_u <= static_cast<float>(image.width - 1) &&
        v + reach_v <= static_cast<float>(image.height - 1)))
    return false;
  plan.size = size;
  plan.first_row = static_cast<int>(v - reach_v) - 1;
  plan.rows = static_cast<int>(v + reach_v) + 3 - plan.first_row;
  const float above = v - static_cast<float>(plan.first_row);  // rows from the first to the middle of the patch
  // The first and the last row read may start furthest left.
  const float below = static_cast<float>(plan.rows - 1) - above;
  const float left = u - step * center - std::max(slant * above, -slant * below);
  plan.first_column = static_cast<int>(std::floor(left)) - 1;
  plan.step = fixed(step);
  plan.along = Progression(plan.step);
  plan.row_slope = fixed(A[2]);
  plan.down = Progression(plan.row_slope);
  plan.column_per_row = fixed(slant);
  plan.column_base = fixed(u - step * center - slant * above - static_cast<float>(plan.first_column));
  plan.row_per_row = fixed(A[3]);
  plan.row_base = fixed(above - 1 - center * (A[2] + A[3]));
  plan.half_step = static_cast<std::int16_t>(fixed(0.5F * step));
  plan.half_slope = static_cast<std::int16_t>(fixed(0.5F * A[2]));
  plan.half_height = static_cast<std::int16_t>(fixed(0.5F * A[3]));
  return true;
}

}  // namespace pelorus::shear

namespace pelorus {
// Value and gradients; the mask is left alone.
void sample_sheared(const ImageView& image, const shear::Plan& plan, PatchTemplate& patch);
namespace reference {
void sample_sheared(const ImageView& image, const shear::Plan& plan, PatchTemplate& patch);
}
}  // namespace pelorus
