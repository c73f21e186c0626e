#include "core/frontend/klt.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/frontend/klt_level.h"

namespace pelorus {
namespace {

using namespace klt;

constexpr float kCoarseEpsilonPx = 0.06F;  // a coarse level only has to bring the next one into its basin

// A prediction holds when full resolution alone ends this near and this like. Of 26000 points on textures with the
// prediction 4 to 15 px wrong none is taken in; at 1.5 px and 0.9 it were 30.
constexpr float kConfirmedPx = 1.0F;
constexpr float kConfirmedNcc = 0.95F;

void keep(const LevelSearch& search, float scale, KltTask& task) {
  task.ncc = search.ncc;
  task.residual_rms = search.residual_rms;
  for (std::size_t i = 0; i < 3; ++i) task.structure[i] = search.structure[i] * scale * scale;
}

// A task on its way down the levels. Places in full-resolution pixels.
struct Descent {
  const KltConfig& config;
  const ImagePyramid& from;
  const ImagePyramid& to;
  KltSearch direction;
  TaskWarp warp;
  Place predicted;
  Place place;  // moves only where a level succeeded
  Place hint;   // moves also to a doubtful answer that bettered its start
  bool found = false;

  bool track(int level, Place start, KltTask& task) {
    const float scale = 1.0F / static_cast<float>(1 << level);
    LevelSearch search{from.level(level),
                       to.level(level),
                       {task.u_from_px * scale, task.v_from_px * scale},
                       {start.u_px * scale, start.v_px * scale}};
    search.coarser_agreed = found && start == place;
    const float epsilon = level == 0 ? config.epsilon_px : std::max(config.epsilon_px, kCoarseEpsilonPx);
    const KltOutcome outcome = track_level(config, warp, direction, epsilon, search);
    const auto back = static_cast<float>(1 << level);
    const Place end{search.place.u_px * back, search.place.v_px * back};
    if (outcome == KltOutcome::ok || !found) {
      task.level = level;
      task.outcome = outcome;
      keep(search, scale, task);
    }
    if (outcome == KltOutcome::ok) {
      found = true;
      place = hint = end;
    } else if (search.ncc > search.start_ncc) {
      hint = end;
    }
    return outcome == KltOutcome::ok;
  }

  // Full resolution first; false leaves the descent as it was.
  bool confirm(KltTask& task) {
    if (track(0, predicted, task) && task.ncc >= kConfirmedNcc && distance(place, predicted) <= kConfirmedPx)
      return true;
    found = false;
    place = hint = predicted;
    return false;
  }

  // A coarse answer may belong to another surface in its wide window: then the earlier ones get their chance.
  void descend(int level, KltTask& task) {
    const std::array<Place, 3> starts{hint, place, predicted};
    const auto near = static_cast<float>(1 << level);  // a pixel of the level: the same basin
    for (auto start = starts.begin(); start != starts.end(); ++start) {
      const bool tried = std::any_of(starts.begin(), start, [&](Place p) { return distance(p, *start) <= near; });
      if (!tried && track(level, *start, task)) return;
    }
  }
};

void refine_with_slant(Descent& descent, KltTask& task) {
  LevelSearch search{descent.from.level(0), descent.to.level(0), {task.u_from_px, task.v_from_px}, descent.place};
  if (refine_slant(descent.config, search, task.warp) != KltOutcome::ok) return;
  descent.place = search.place;
  task.level = 0;
  keep(search, 1.0F, task);
}

void track_task(const KltConfig& config, const ImagePyramid& from, const ImagePyramid& to, KltSearch direction,
                int coarsest, bool predicted_well, KltTask& task) {
  task.outcome = KltOutcome::diverged;
  TaskWarp warp;
  if (!invert(task.warp, warp)) return;
  const Place predicted{task.u_to_px, task.v_to_px};
  Descent descent{config, from, to, direction, warp, predicted, predicted, predicted};
  if (!(predicted_well && coarsest > 0 && descent.confirm(task))) {
    for (int level = coarsest; level >= 0; --level) descent.descend(level, task);
  }
  if (!descent.found) return;
  if (direction == KltSearch::slanted_row) refine_with_slant(descent, task);
  task.outcome = KltOutcome::ok;
  task.u_to_px = descent.place.u_px;
  task.v_to_px = descent.place.v_px;
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
                int coarsest_level, bool predicted) const {
  const int available = std::min({from.levels(), to.levels(), config_.levels}) - 1;
  PELORUS_CHECK(available >= 0, "track() before the pyramids were built");
  const int coarsest = std::clamp(coarsest_level, 0, available);
  for (KltTask& task : tasks) track_task(config_, from, to, search, coarsest, predicted, task);
}

}  // namespace pelorus
