// Row search with slant: a plane seen by both cameras shears and stretches along the row, u_to = u_from - d + a x + b y
// (Birchfield & Tomasi 1999; affine template of Shi & Tomasi 1994 with its second row fixed by rectification).
#include <algorithm>
#include <cmath>

#include "core/frontend/klt_level.h"

namespace pelorus::klt {
namespace {

constexpr int kMaxRewarps = 5;
constexpr float kMaxSlope = 0.7F;       // of the first row of A against the identity
constexpr float kMaxSlopeStep = 0.2F;   // per iteration
constexpr float kMaxDriftPx = 2.5F;     // from where the plain search ended
constexpr float kSlopeSigma = 0.25F;    // prior about the given warp: keeps the slope of weak texture at bay
constexpr float kNoiseVariance = 4.0F;  // grey levels^2, for that prior

struct SlantStep {
  float u_px, slope_x, slope_y;
  float information;  // of u with both slopes unknown
};

// Solves the symmetric 3x3 system by elimination of the slopes.
SlantStep solve(const std::array<float, 6>& H, const std::array<float, 3>& e) {
  const float xx = H[3];
  const float xy = H[4];
  const float yy = H[5];
  const float scale = 1.0F / (xx * yy - xy * xy);
  const float kx = (yy * H[1] - xy * H[2]) * scale;  // slopes per unit of u
  const float ky = (xx * H[2] - xy * H[1]) * scale;
  SlantStep step{};
  step.information = H[0] - (kx * H[1] + ky * H[2]);
  step.u_px = (e[0] - (kx * e[1] + ky * e[2])) / step.information;
  const float ex = e[1] - H[1] * step.u_px;
  const float ey = e[2] - H[2] * step.u_px;
  step.slope_x = (yy * ex - xy * ey) * scale;
  step.slope_y = (xx * ey - xy * ex) * scale;
  return step;
}

bool plausible(const std::array<float, 4>& A) {
  return std::abs(A[0] - 1) <= kMaxSlope && std::abs(A[1]) <= kMaxSlope;  // false for NaN
}

struct Trial {
  LevelSearch search;
  std::array<float, 4> A;
  float slope_x = 0;  // steps so far, for the prior
  float slope_y = 0;
  bool settled = false;
};

// One re-warp of the template and one step; false when the trial leads nowhere.
bool improve(const KltConfig& config, float epsilon_px, Trial& trial) {
  TaskWarp warp;
  if (!plausible(trial.A) || !invert(trial.A, warp) || !inside(trial.search.to, trial.search.place)) return false;
  warp.identity = false;
  PatchTemplate patch;
  patch.size = 2 * config.half_window_px + 1;
  sample_template(trial.search, warp, patch);
  if (!(patch.structure_uu >= config.min_eigenvalue * patch.count)) return false;
  PatchSlant slant;
  prepare_slant(patch, slant);
  const auto half = static_cast<float>(config.half_window_px);
  const Place at = trial.search.place;
  const SlantSums sums = compare_slanted_patch(trial.search.to, at.u_px - half, at.v_px - half, patch, slant);
  const PatchFit fit = fit_of(patch, sums.plain);
  if (fit.spread <= 0) return false;
  const float prior = kNoiseVariance / (kSlopeSigma * kSlopeSigma);
  std::array<float, 6> H = slant.structure;
  H[3] += prior;
  H[5] += prior;
  const SlantStep step =
      solve(H, {sums.plain.gradient_u * fit.per_gain, sums.slope_x * fit.per_gain - prior * trial.slope_x,
                sums.slope_y * fit.per_gain - prior * trial.slope_y});
  const float sx = std::clamp(step.slope_x, -kMaxSlopeStep, kMaxSlopeStep);
  const float sy = std::clamp(step.slope_y, -kMaxSlopeStep, kMaxSlopeStep);
  judge(patch, fit, trial.search);
  trial.search.structure = {step.information / patch.count, 0, patch.structure_vv / patch.count};
  trial.search.place.u_px -= step.u_px;
  // The field error found is s = sx x + sy y at offset (x, y) in `to`: A <- (1 - s) A.
  const std::array<float, 4> A = trial.A;
  trial.A[0] = A[0] - (sx * A[0] + sy * A[2]);
  trial.A[1] = A[1] - (sx * A[1] + sy * A[3]);
  trial.slope_x -= sx;
  trial.slope_y -= sy;
  trial.settled = std::abs(step.u_px) <= epsilon_px && (std::abs(sx) + std::abs(sy)) * half <= 10 * epsilon_px;
  return std::isfinite(step.u_px);
}

}  // namespace

KltOutcome refine_slant(const KltConfig& config, LevelSearch& search, std::array<float, 4>& A) {
  Trial trial{search, A};
  for (int i = 0; i < kMaxRewarps && !trial.settled; ++i) {
    if (!improve(config, config.epsilon_px, trial)) return KltOutcome::diverged;
    if (std::abs(trial.search.place.u_px - search.place.u_px) > kMaxDriftPx) return KltOutcome::diverged;
  }
  if (!plausible(trial.A) || !inside(search.to, trial.search.place)) return KltOutcome::diverged;
  if (trial.search.ncc < config.min_ncc) return KltOutcome::low_correlation;
  search.place = trial.search.place;
  search.ncc = trial.search.ncc;
  search.residual_rms = trial.search.residual_rms;
  search.structure = trial.search.structure;
  A = trial.A;
  return KltOutcome::ok;
}

}  // namespace pelorus::klt
