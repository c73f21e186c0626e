#include "core/frontend/klt_level.h"

#include <algorithm>
#include <cmath>

#include "core/kernels/patch_overlap.h"

namespace pelorus::klt {
namespace {

constexpr float kMaxStepPx = 2.0F;  // per iteration, level pixels: the linearisation reaches no further
constexpr float kSettledPx = 0.1F;  // last step accepted when the iterations run out
constexpr float kMaxDriftPerHalfWindow = 1.5F;
constexpr float kConfirmedReachPx =
    3.0F;  // a coarser level is right to about half a pixel of its own and its scale error
// Most iterations of lost points are spent after this; few that are so far off by then still arrive.
constexpr int kPatience = 4;
constexpr float kHopelessNcc = 0.3F;
constexpr float kMinCoverage = 0.5F;  // share of the window that both images must show

float least_eigenvalue(float uu, float uv, float vv) {
  const float half_difference = 0.5F * (uu - vv);
  return 0.5F * (uu + vv) - std::sqrt(half_difference * half_difference + uv * uv);
}

// Gauss-Newton step of the offset, gain and translation model with offset and gain eliminated.
Place newton_step(const PatchTemplate& patch, const PatchSums& sums, float gain, KltSearch search) {
  const float eu = sums.gradient_u / gain;
  const float ev = sums.gradient_v / gain;
  if (search != KltSearch::plane) return {eu / patch.structure_uu, 0};
  const float uu = patch.structure_uu;
  const float uv = patch.structure_uv;
  const float vv = patch.structure_vv;
  const float scale = 1.0F / (uu * vv - uv * uv);
  return {(vv * eu - uv * ev) * scale, (uu * ev - uv * eu) * scale};
}

bool has_texture(const PatchTemplate& patch, KltSearch search, float min_eigenvalue) {
  const float eigenvalue = search != KltSearch::plane
                               ? patch.structure_uu
                               : least_eigenvalue(patch.structure_uu, patch.structure_uv, patch.structure_vv);
  return eigenvalue >= min_eigenvalue * patch.count && patch.energy > kMinPatchContrast * patch.count;
}

KltOutcome iterate(const KltConfig& config, const PatchTemplate& patch, KltSearch direction, float epsilon_px,
                   LevelSearch& search) {
  const auto half = static_cast<float>(config.half_window_px);
  const float reach = kMaxDriftPerHalfWindow * half;
  const Place start = search.place;
  float last_step = kMaxStepPx;
  PatchFit fit;
  for (int i = 0; i < config.max_iterations && last_step > epsilon_px; ++i) {
    const PatchSums sums = compare_patch(search.to, search.place.u_px - half, search.place.v_px - half, patch);
    fit = fit_of(patch, sums);
    if (fit.spread <= 0) return KltOutcome::low_correlation;
    if (i == 0) search.start_ncc = fit.ncc;
    if (i >= kPatience && fit.ncc < kHopelessNcc) return KltOutcome::low_correlation;
    // Gain as ratio of contrasts: equals the fitted gain at the solution and stays tame far from it.
    Place step = newton_step(patch, sums, std::sqrt(fit.spread / patch.energy), direction);
    last_step = distance(step, {});
    const float scale = last_step > kMaxStepPx ? kMaxStepPx / last_step : 1.0F;
    search.place.u_px -= scale * step.u_px;
    search.place.v_px -= scale * step.v_px;
    if (!inside(search.to, search.place)) return KltOutcome::out_of_image;
    if (distance(search.place, start) > reach) return KltOutcome::diverged;
  }
  judge(patch, fit, search);
  if (!(last_step <= std::max(epsilon_px, kSettledPx))) return KltOutcome::diverged;
  const bool confirmed = search.coarser_agreed && distance(search.place, start) <= kConfirmedReachPx;
  const float min_ncc = confirmed ? config.confirmed_ncc : config.min_ncc;
  return fit.ncc >= min_ncc ? KltOutcome::ok : KltOutcome::low_correlation;
}

}  // namespace

bool invert(const std::array<float, 4>& A, TaskWarp& warp) {
  warp.identity = A[0] == 1 && A[1] == 0 && A[2] == 0 && A[3] == 1;
  if (warp.identity) return true;
  const float determinant = A[0] * A[3] - A[1] * A[2];
  if (!(determinant > 1e-2F && determinant < 1e2F)) return false;
  warp.A_from_to = {A[3] / determinant, -A[1] / determinant, -A[2] / determinant, A[0] / determinant};
  return std::all_of(warp.A_from_to.begin(), warp.A_from_to.end(), [](float a) { return std::isfinite(a); });
}

bool inside(const ImageView& image, Place p) {  // false for NaN
  return p.u_px >= 0 && p.v_px >= 0 && p.u_px <= static_cast<float>(image.width - 1) &&
         p.v_px <= static_cast<float>(image.height - 1);
}

void sample_template(const LevelSearch& search, const TaskWarp& warp, PatchTemplate& patch) {
  const float half = 0.5F * static_cast<float>(patch.size - 1);
  Overlap columns = overlap(search.place.u_px - half, patch.size, search.to.width);
  Overlap rows = overlap(search.place.v_px - half, patch.size, search.to.height);
  const Place first{search.start_from.u_px - half, search.start_from.v_px - half};
  if (warp.identity) {
    columns = columns & overlap(first.u_px, patch.size, search.from.width);
    rows = rows & overlap(first.v_px, patch.size, search.from.height);
    set_weights(patch, columns, rows);
    sample_patch(search.from, first.u_px, first.v_px, patch);
  } else {
    set_weights(patch, columns, rows);
    sample_warped_patch(search.from, search.start_from.u_px, search.start_from.v_px, warp.A_from_to, patch);
  }
  normalise(patch);
}

void judge(const PatchTemplate& patch, const PatchFit& fit, LevelSearch& search) {
  search.ncc = fit.ncc;
  const float residual = std::max(0.0F, fit.spread * (1.0F - fit.ncc * fit.ncc));
  search.residual_rms = std::sqrt(residual / (patch.count * kSplineNoisePower));
}

KltOutcome track_level(const KltConfig& config, const TaskWarp& warp, KltSearch direction, float epsilon_px,
                       LevelSearch& search) {
  if (!inside(search.from, search.start_from) || !inside(search.to, search.place)) return KltOutcome::out_of_image;
  PatchTemplate patch;
  patch.size = 2 * config.half_window_px + 1;
  sample_template(search, warp, patch);
  const auto area = static_cast<float>(patch.size * patch.size);
  if (patch.count < kMinCoverage * area) return KltOutcome::out_of_image;
  search.structure = {patch.structure_uu / patch.count, patch.structure_uv / patch.count,
                      patch.structure_vv / patch.count};
  if (!has_texture(patch, direction, config.min_eigenvalue)) return KltOutcome::low_texture;
  return iterate(config, patch, direction, epsilon_px, search);
}

}  // namespace pelorus::klt
