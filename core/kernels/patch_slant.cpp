// The part of patch.h for slanted surfaces: new points only, so written as plain loops over 16 columns that the
// compiler vectorises for the baseline instruction set.
#include <algorithm>
#include <cstddef>

#include "core/kernels/patch.h"

namespace pelorus {
namespace {

constexpr auto kColumns = static_cast<std::size_t>(kPatchStride);
using ColumnSum = std::array<float, kColumns>;

float collect(ColumnSum& columns) {
  for (std::size_t half = kColumns / 2; half > 0; half /= 2) {
    for (std::size_t c = 0; c < half; ++c) columns[c] += columns[c + half];
  }
  return columns[0];
}

float product_sum(const PatchRows& a, const PatchRows& b, int size) {
  ColumnSum columns{};
  const std::size_t end = static_cast<std::size_t>(size) * kColumns;
  for (std::size_t row = 0; row < end; row += kColumns) {
    for (std::size_t c = 0; c < kColumns; ++c) columns[c] += a[row + c] * b[row + c];
  }
  return collect(columns);
}

// image -= mean + along * value, inside the window.
void make_orthogonal(const PatchTemplate& patch, PatchRows& image) {
  const std::size_t end = static_cast<std::size_t>(patch.size) * kColumns;
  const float mean = product_sum(image, patch.weight, patch.size) / std::max(patch.count, 1.0F);
  const float along = product_sum(image, patch.value, patch.size) / std::max(patch.energy, 1e-6F);
  for (std::size_t i = 0; i < end; ++i) image[i] = patch.weight[i] * (image[i] - mean) - along * patch.value[i];
}

}  // namespace

void prepare_slant(const PatchTemplate& patch, PatchSlant& slant) {
  const float center = 0.5F * static_cast<float>(patch.size - 1);
  for (int r = 0; r < patch.size; ++r) {
    const float y = static_cast<float>(r) - center;
    for (int c = 0; c < kPatchStride; ++c) {
      const auto i = static_cast<std::size_t>(r * kPatchStride + c);
      slant.slope_x[i] = patch.gradient_u[i] * (static_cast<float>(c) - center);
      slant.slope_y[i] = patch.gradient_u[i] * y;
    }
  }
  make_orthogonal(patch, slant.slope_x);
  make_orthogonal(patch, slant.slope_y);
  slant.structure = {patch.structure_uu,
                     product_sum(patch.gradient_u, slant.slope_x, patch.size),
                     product_sum(patch.gradient_u, slant.slope_y, patch.size),
                     product_sum(slant.slope_x, slant.slope_x, patch.size),
                     product_sum(slant.slope_x, slant.slope_y, patch.size),
                     product_sum(slant.slope_y, slant.slope_y, patch.size)};
}

SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                const PatchSlant& slant) {
  PatchTemplate seen;  // the gradients it samples too are not needed: new points are few
  seen.size = patch.size;
  sample_patch(image, u, v, seen);
  const std::size_t end = static_cast<std::size_t>(patch.size) * kColumns;
  for (std::size_t i = 0; i < end; ++i) seen.value[i] = patch.weight[i] * (seen.value[i] - patch.mean);
  SlantSums sums;
  sums.plain.gradient_u = product_sum(patch.gradient_u, seen.value, patch.size);
  sums.plain.gradient_v = product_sum(patch.gradient_v, seen.value, patch.size);
  sums.plain.value = product_sum(patch.value, seen.value, patch.size);
  sums.plain.sum = product_sum(patch.weight, seen.value, patch.size);
  sums.plain.square = product_sum(seen.value, seen.value, patch.size);
  sums.slope_x = product_sum(slant.slope_x, seen.value, patch.size);
  sums.slope_y = product_sum(slant.slope_y, seen.value, patch.size);
  return sums;
}

}  // namespace pelorus
