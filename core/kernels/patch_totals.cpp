#include "core/kernels/patch_totals.h"

#include <algorithm>

namespace pelorus {
namespace {

constexpr double kPerUnit = 1.0 / kPatchUnits;
constexpr double kPerUnit2 = kPerUnit * kPerUnit;
constexpr double kPerSlantUnit = 1.0 / PatchSlant::kUnits;

double real(std::int64_t sum) { return static_cast<double>(sum); }
// Sum of squares of the value about its mean, units^2; never zero.
double energy_units(const PatchTemplate& patch) {
  return std::max(static_cast<double>(patch.energy) / kPerUnit2, 1e-3);
}

}  // namespace

void finish(const TemplateTotals& t, PatchTemplate& patch) {
  patch.count = static_cast<float>(t.count);
  patch.per_count = 1.0 / std::max(1.0, real(t.count));
  patch.value_offset = real(t.value) * patch.per_count;
  patch.offset_u = real(t.u) * patch.per_count;
  patch.offset_v = real(t.v) * patch.per_count;
  const double energy = real(t.value_value) - patch.value_offset * real(t.value);
  patch.energy = static_cast<float>(energy * kPerUnit2);
  patch.per_energy = patch.energy > 0 ? 1.0F / patch.energy : 0.0F;
  const double per_energy = 1.0 / energy_units(patch);
  const double value_u = real(t.value_u) - patch.value_offset * real(t.u);
  const double value_v = real(t.value_v) - patch.value_offset * real(t.v);
  patch.along_u = value_u * per_energy;
  patch.along_v = value_v * per_energy;
  const auto structure = [&](std::int64_t product, double offset, std::int64_t sum, double along, double value) {
    return static_cast<float>((real(product) - offset * real(sum) - along * value) * kPerUnit2);
  };
  patch.structure_uu = structure(t.u_u, patch.offset_u, t.u, patch.along_u, value_u);
  patch.structure_uv = structure(t.u_v, patch.offset_u, t.v, patch.along_u, value_v);
  patch.structure_vv = structure(t.v_v, patch.offset_v, t.v, patch.along_v, value_v);
}

void finish(const SlantTotals& t, const PatchTemplate& patch, PatchSlant& slant) {
  slant.offset_x = real(t.x) * patch.per_count;
  slant.offset_y = real(t.y) * patch.per_count;
  const double per_energy = 1.0 / energy_units(patch);
  const double value_x = real(t.value_x) - patch.value_offset * real(t.x);
  const double value_y = real(t.value_y) - patch.value_offset * real(t.y);
  slant.along_x = value_x * per_energy;
  slant.along_y = value_y * per_energy;
  const double mixed = kPerUnit * kPerSlantUnit;
  const double square = kPerSlantUnit * kPerSlantUnit;
  const auto with_u = [&](std::int64_t product, std::int64_t sum, double value) {
    return static_cast<float>((real(product) - patch.offset_u * real(sum) - patch.along_u * value) * mixed);
  };
  slant.structure = {patch.structure_uu,
                     with_u(t.u_x, t.x, value_x),
                     with_u(t.u_y, t.y, value_y),
                     static_cast<float>((real(t.x_x) - slant.offset_x * real(t.x) - slant.along_x * value_x) * square),
                     static_cast<float>((real(t.x_y) - slant.offset_x * real(t.y) - slant.along_x * value_y) * square),
                     static_cast<float>((real(t.y_y) - slant.offset_y * real(t.y) - slant.along_y * value_y) * square)};
}

SlantSums finish(const SlantComparisonTotals& t, const PatchTemplate& patch, const PatchSlant& slant) {
  const double sum = real(t.plain.sum);
  const double value = real(t.plain.value) - patch.value_offset * sum;
  const double scale = kPerUnit * kPerSlantUnit;
  return {finish(t.plain, patch),
          static_cast<float>((real(t.x) - slant.offset_x * sum - slant.along_x * value) * scale),
          static_cast<float>((real(t.y) - slant.offset_y * sum - slant.along_y * value) * scale)};
}

}  // namespace pelorus
