#pragma once
// From integer sums over a patch to the figures of patch.h: mean and template are projected out here, once per sum
// instead of once per pixel. Shared by the vector and the scalar path; not for callers. Pure. O(1).

#include <cstdint>

#include "core/kernels/patch.h"

namespace pelorus {

// Sums over the pixels in use, in units of the stored rows (value relative to PatchTemplate::mean).
struct TemplateTotals {
  std::int64_t count = 0;
  std::int64_t value = 0, u = 0, v = 0;
  std::int64_t value_value = 0, value_u = 0, value_v = 0;
  std::int64_t u_u = 0, u_v = 0, v_v = 0;
};
void finish(const TemplateTotals& totals, PatchTemplate& patch);

// Of an image patch, relative to PatchTemplate::mean, with the stored rows.
struct ComparisonTotals {
  std::int64_t u = 0, v = 0, value = 0, sum = 0, square = 0;
};
// Inline: on the way from one step of a search to the next.
[[nodiscard]] inline PatchSums finish(const ComparisonTotals& t, const PatchTemplate& patch) {
  constexpr double kPerUnit2 = 1.0 / (kPatchUnits * kPatchUnits);
  const auto sum = static_cast<double>(t.sum);
  const double value = static_cast<double>(t.value) - patch.value_offset * sum;  // both about their means
  const double u = static_cast<double>(t.u) - patch.offset_u * sum - patch.along_u * value;
  const double v = static_cast<double>(t.v) - patch.offset_v * sum - patch.along_v * value;
  const double spread = static_cast<double>(t.square) - sum * sum * patch.per_count;
  return {static_cast<float>(u * kPerUnit2), static_cast<float>(v * kPerUnit2), static_cast<float>(value * kPerUnit2),
          static_cast<float>(spread * kPerUnit2)};
}

struct SlantTotals {
  std::int64_t x = 0, y = 0;
  std::int64_t value_x = 0, value_y = 0;
  std::int64_t u_x = 0, u_y = 0;
  std::int64_t x_x = 0, x_y = 0, y_y = 0;
};
void finish(const SlantTotals& totals, const PatchTemplate& patch, PatchSlant& slant);

struct SlantComparisonTotals {
  ComparisonTotals plain;
  std::int64_t x = 0, y = 0;
};
[[nodiscard]] SlantSums finish(const SlantComparisonTotals& totals, const PatchTemplate& patch,
                               const PatchSlant& slant);

// The mean of `count` values that sum to `sum`, rounded to a unit.
[[nodiscard]] inline int rounded_mean(std::int64_t sum, std::int64_t count) {
  return count > 0 ? static_cast<int>((2 * sum + count) / (2 * count)) : 0;
}

}  // namespace pelorus
