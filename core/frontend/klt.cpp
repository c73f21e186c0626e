#include "core/frontend/klt.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/kernels/patch.h"

namespace pelorus {
namespace {

constexpr float kCoarseEpsilonPx = 0.03F;  // a coarse level only has to bring the next one into its basin
constexpr float kMaxStepPx = 2.0F;         // per iteration, level pixels: the linearisation reaches no further
constexpr float kSettledPx = 0.1F;         // last step accepted when the iterations run out
constexpr float kMinCoverage = 0.5F;       // share of the window that both images must show
constexpr float kMinEnergyPerPixel = 0.05F;
// Power of white noise that passes the spline taps: (sum of squared taps)^2, 0.21..0.25 over all fractions.
constexpr float kSplineNoisePower = 0.23F;

struct Place {
  float u_px = 0;
  float v_px = 0;
};

// One level's question and answer, in pixels of that level.
struct LevelSearch {
  const ImageView& from;
  const ImageView& to;
  Place start_from;
  Place place;
  float ncc = 0;
  float residual_rms = 0;
  std::array<float, 3> structure{};
};

struct TaskWarp {
  bool identity = true;
  std::array<float, 4> A_from_to{1, 0, 0, 1};
};

bool inside(const ImageView& image, Place p) {  // false for NaN
  return p.u_px >= 0 && p.v_px >= 0 && p.u_px <= static_cast<float>(image.width - 1) &&
         p.v_px <= static_cast<float>(image.height - 1);
}

// First and one past the last index of a window of `size` pixels from `first` on that lie in [0, extent - 1].
struct Overlap {
  int begin;
  int end;
};
Overlap overlap(float first, int size, int extent) {
  const int begin = std::max(0, static_cast<int>(std::ceil(-first)));
  const int end = std::min(size, static_cast<int>(std::floor(static_cast<float>(extent - 1) - first)) + 1);
  return {begin, std::max(begin, end)};
}

Overlap operator&(Overlap a, Overlap b) {
  const int begin = std::max(a.begin, b.begin);
  return {begin, std::max(begin, std::min(a.end, b.end))};
}

void set_weights(PatchTemplate& patch, Overlap columns, Overlap rows) {
  patch.weight.fill(0);
  for (int r = rows.begin; r < rows.end; ++r) {
    float* row = patch.weight.data() + r * kPatchStride;
    std::fill(row + columns.begin, row + columns.end, 1.0F);
  }
}

// The template's window shows only what lies in both images.
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

float least_eigenvalue(float uu, float uv, float vv) {
  const float half_difference = 0.5F * (uu - vv);
  return 0.5F * (uu + vv) - std::sqrt(half_difference * half_difference + uv * uv);
}

// Gauss-Newton step of the offset, gain and translation model with offset and gain eliminated.
Place newton_step(const PatchTemplate& patch, const PatchSums& sums, float gain, KltSearch search) {
  const float eu = sums.gradient_u / gain;
  const float ev = sums.gradient_v / gain;
  if (search == KltSearch::row) return {eu / patch.structure_uu, 0};
  const float uu = patch.structure_uu;
  const float uv = patch.structure_uv;
  const float vv = patch.structure_vv;
  const float scale = 1.0F / (uu * vv - uv * uv);
  return {(vv * eu - uv * ev) * scale, (uu * ev - uv * eu) * scale};
}

struct Fit {
  float spread = 0;  // sum of squares of the image patch about its mean
  float ncc = 0;
};
Fit fit_of(const PatchTemplate& patch, const PatchSums& sums) {
  const float spread = sums.square - sums.sum * sums.sum / patch.count;
  if (!(spread > kMinEnergyPerPixel * patch.count)) return {0, 0};
  return {spread, sums.value / std::sqrt(patch.energy * spread)};
}

bool has_texture(const PatchTemplate& patch, KltSearch search, float min_eigenvalue) {
  const float eigenvalue = search == KltSearch::row
                               ? patch.structure_uu
                               : least_eigenvalue(patch.structure_uu, patch.structure_uv, patch.structure_vv);
  return eigenvalue >= min_eigenvalue * patch.count && patch.energy > kMinEnergyPerPixel * patch.count;
}

KltOutcome iterate(const KltConfig& config, const PatchTemplate& patch, KltSearch direction, float epsilon,
                   LevelSearch& search) {
  const auto half = static_cast<float>(config.half_window_px);
  const Place start = search.place;
  float last_step = kMaxStepPx;
  Fit fit;
  for (int i = 0; i < config.max_iterations && last_step > epsilon; ++i) {
    const PatchSums sums = compare_patch(search.to, search.place.u_px - half, search.place.v_px - half, patch);
    fit = fit_of(patch, sums);
    if (fit.spread <= 0) return KltOutcome::low_correlation;
    // Gain as ratio of contrasts: equals the fitted gain at the solution and stays tame far from it.
    Place step = newton_step(patch, sums, std::sqrt(fit.spread / patch.energy), direction);
    last_step = std::hypot(step.u_px, step.v_px);
    const float scale = last_step > kMaxStepPx ? kMaxStepPx / last_step : 1.0F;
    search.place.u_px -= scale * step.u_px;
    search.place.v_px -= scale * step.v_px;
    if (!inside(search.to, search.place)) return KltOutcome::out_of_image;
    if (std::hypot(search.place.u_px - start.u_px, search.place.v_px - start.v_px) > half) return KltOutcome::diverged;
  }
  search.ncc = fit.ncc;
  const float residual = std::max(0.0F, fit.spread * (1.0F - fit.ncc * fit.ncc));
  search.residual_rms = std::sqrt(residual / (patch.count * kSplineNoisePower));
  if (!(last_step <= std::max(epsilon, kSettledPx))) return KltOutcome::diverged;
  return fit.ncc >= config.min_ncc ? KltOutcome::ok : KltOutcome::low_correlation;
}

KltOutcome track_level(const KltConfig& config, const TaskWarp& warp, KltSearch direction, float epsilon,
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
  return iterate(config, patch, direction, epsilon, search);
}

// False when the warp cannot be inverted (or is not finite): nothing can be compared then.
bool invert(const std::array<float, 4>& A, TaskWarp& warp) {
  warp.identity = A[0] == 1 && A[1] == 0 && A[2] == 0 && A[3] == 1;
  if (warp.identity) return true;
  const float determinant = A[0] * A[3] - A[1] * A[2];
  if (!(determinant > 1e-2F && determinant < 1e2F)) return false;
  warp.A_from_to = {A[3] / determinant, -A[1] / determinant, -A[2] / determinant, A[0] / determinant};
  return std::all_of(warp.A_from_to.begin(), warp.A_from_to.end(), [](float a) { return std::isfinite(a); });
}

void keep(const LevelSearch& search, float scale, KltTask& task) {
  task.ncc = search.ncc;
  task.residual_rms = search.residual_rms;
  for (std::size_t i = 0; i < 3; ++i) task.structure[i] = search.structure[i] * scale * scale;
}

void track_task(const KltConfig& config, const ImagePyramid& from, const ImagePyramid& to, KltSearch direction,
                int coarsest, KltTask& task) {
  TaskWarp warp;
  task.outcome = KltOutcome::diverged;
  if (!invert(task.warp, warp)) return;
  Place place{task.u_to_px, task.v_to_px};  // full resolution; moves only where a level succeeded
  bool found = false;
  for (int level = coarsest; level >= 0; --level) {
    const float scale = std::ldexp(1.0F, -level);
    LevelSearch search{from.level(level),
                       to.level(level),
                       {task.u_from_px * scale, task.v_from_px * scale},
                       {place.u_px * scale, place.v_px * scale}};
    const float epsilon = level == 0 ? config.epsilon_px : std::max(config.epsilon_px, kCoarseEpsilonPx);
    const KltOutcome outcome = track_level(config, warp, direction, epsilon, search);
    if (outcome == KltOutcome::ok) {
      found = true;
      place = {search.place.u_px / scale, search.place.v_px / scale};
      task.level = level;
      keep(search, scale, task);
    } else if (!found) {
      task.level = level;
      keep(search, scale, task);
      task.outcome = outcome;
    }
  }
  if (!found) return;
  task.outcome = KltOutcome::ok;
  task.u_to_px = place.u_px;
  task.v_to_px = place.v_px;
}

}  // namespace

const char* to_text(KltOutcome outcome) {
  switch (outcome) {
    case KltOutcome::ok:
      return "ok";
    case KltOutcome::out_of_image:
      return "out_of_image";
    case KltOutcome::low_texture:
      return "low_texture";
    case KltOutcome::diverged:
      return "diverged";
    case KltOutcome::low_correlation:
      return "low_correlation";
  }
  return "unknown";
}

Klt::Klt(const KltConfig& config) : config_(config) {
  PELORUS_CHECK(config.half_window_px >= 2 && 2 * config.half_window_px + 1 <= kPatchMaxSize,
                "KLT half window must be 2..7 px");
  PELORUS_CHECK(config.levels >= 1 && config.levels <= ImagePyramid::kMaxLevels, "KLT levels must be 1..8");
  PELORUS_CHECK(config.max_iterations >= 1, "KLT needs an iteration");
}

void Klt::track(const ImagePyramid& from, const ImagePyramid& to, std::span<KltTask> tasks, KltSearch search,
                int coarsest_level) const {
  const int available = std::min({from.levels(), to.levels(), config_.levels}) - 1;
  PELORUS_CHECK(available >= 0, "track() before the pyramids were built");
  const int coarsest = std::clamp(coarsest_level, 0, available);
  for (KltTask& task : tasks) track_task(config_, from, to, search, coarsest, task);
}

}  // namespace pelorus
