#include "core/frontend/klt.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/frontend/klt_level.h"

namespace pelorus {
namespace {

using namespace klt;

constexpr float kCoarseEpsilonPx = 0.03F;  // a coarse level only has to bring the next one into its basin

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
  if (direction == KltSearch::slanted_row) {
    LevelSearch search{from.level(0), to.level(0), {task.u_from_px, task.v_from_px}, place};
    if (refine_slant(config, search, task.warp) == KltOutcome::ok) {
      place = search.place;
      task.level = 0;
      keep(search, 1.0F, task);
    }
  }
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
