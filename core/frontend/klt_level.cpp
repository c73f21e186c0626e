#include "core/frontend/klt_level.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
constexpr float kDoubtfulNcc = 0.03F;  // below what would be accepted
constexpr float kLeastRise = 0.002F;   // of the correlation per iteration, while it is doubtful
constexpr float kMinCoverage = 0.5F;   // share of the window that both images must show

float least_eigenvalue(float uu, float uv, float vv) {
  const float half_difference = 0.5F * (uu - vv);
  return 0.5F * (uu + vv) - std::sqrt(half_difference * half_difference + uv * uv);
}

// Gauss-Newton step of the offset, gain and translation model with offset and gain eliminated: the inverse of the
// structure, ready to be multiplied.
struct Newton {
  float uu = 0;
  float uv = 0;
  float vv = 0;

  Newton(const PatchTemplate& patch, KltSearch search) {
    if (search != KltSearch::plane) {
      uu = 1.0F / patch.structure_uu;
      return;
    }
    const float a = patch.structure_uu;
    const float b = patch.structure_uv;
    const float c = patch.structure_vv;
    const float scale = 1.0F / (a * c - b * b);
    uu = c * scale, uv = -b * scale, vv = a * scale;
  }
  // Gain as ratio of contrasts: equals the fitted gain at the solution and stays tame far from it.
  [[nodiscard]] Place step(const PatchSums& sums, const PatchFit& fit) const {
    return {(uu * sums.gradient_u + uv * sums.gradient_v) * fit.per_gain,
            (uv * sums.gradient_u + vv * sums.gradient_v) * fit.per_gain};
  }
};

float dot(Place a, Place b) { return a.u_px * b.u_px + a.v_px * b.v_px; }

// Near the solution every step is the same small part of the one before: after two of them the rest is known (Aitken's
// delta-squared). The rest as a multiple of the step, or infinity where the steps do not shrink like that.
float rest_after(Place step, Place last) {
  constexpr float kMostShrink = 0.5F;
  const float shrink = dot(step, last) / dot(last, last);  // not finite without a step before
  return std::abs(shrink) < kMostShrink ? shrink / (1 - shrink) : std::numeric_limits<float>::infinity();
}

bool has_texture(const PatchTemplate& patch, KltSearch search, float min_eigenvalue) {
  const float eigenvalue = search != KltSearch::plane
                               ? patch.structure_uu
                               : least_eigenvalue(patch.structure_uu, patch.structure_uv, patch.structure_vv);
  return eigenvalue >= min_eigenvalue * patch.count && patch.energy > kMinPatchContrast * patch.count;
}

// Where a search that will not be accepted ends: far from like, and not getting liker.
bool hopeless(float ncc, float last_ncc, float min_ncc) {
  return ncc < kHopelessNcc || (ncc < min_ncc - kDoubtfulNcc && ncc - last_ncc < kLeastRise);
}

KltOutcome iterate(const KltConfig& config, const PatchTemplate& patch, KltSearch direction, float epsilon_px,
                   LevelSearch& search) {
  const auto half = static_cast<float>(config.half_window_px);
  const Newton newton(patch, direction);
  const Place start = search.place;
  const float reach = kMaxDriftPerHalfWindow * half;
  Place last{};
  PatchFit fit;
  bool settled = false;
  for (int i = 0; i < config.max_iterations && !settled; ++i) {
    const float last_ncc = fit.ncc;
    const PatchSums sums = compare_patch(search.to, search.place.u_px - half, search.place.v_px - half, patch);
    fit = fit_of(patch, sums);
    if (fit.spread <= 0) return KltOutcome::low_correlation;
    if (i == 0) search.start_ncc = fit.ncc;
    if (i >= kPatience && hopeless(fit.ncc, last_ncc, search.coarser_agreed ? config.confirmed_ncc : config.min_ncc)) {
      judge(patch, fit, search);
      return KltOutcome::low_correlation;
    }
    const Place step = newton.step(sums, fit);
    const float length2 = dot(step, step);
    const float rest = rest_after(step, last);
    float scale = 1;
    if (length2 <= epsilon_px * epsilon_px) {
      settled = true;
    } else if (rest * rest * length2 <= epsilon_px * epsilon_px) {
      settled = true;
      scale += rest;
    } else if (length2 > kMaxStepPx * kMaxStepPx) {
      scale = kMaxStepPx / std::sqrt(length2);
    }
    if (i + 1 == config.max_iterations) settled = settled || length2 <= kSettledPx * kSettledPx;
    search.place.u_px -= scale * step.u_px;
    search.place.v_px -= scale * step.v_px;
    last = scale < 1 ? Place{} : step;
    if (!inside(search.to, search.place)) return KltOutcome::out_of_image;
    if (distance(search.place, start) > reach) return KltOutcome::diverged;
  }
  judge(patch, fit, search);
  if (!settled) return KltOutcome::diverged;
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
    set_mask(patch, columns, rows);
    sample_patch(search.from, first.u_px, first.v_px, patch);
  } else {
    set_mask(patch, columns, rows);
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
