#include "core/frontend/stereo_match.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "core/kernels/patch_overlap.h"

namespace pelorus {
namespace {

constexpr int kPeakReach = 2;        // candidates this near the best belong to its peak and are no rivals
constexpr float kLossFloor = 0.02F;  // of 1 - ncc: below it noise decides which of two peaks is better

struct Scores {
  std::array<float, StereoMatcher::kMaxCandidates> ncc{};
  int count = 0;

  [[nodiscard]] float at(int i) const { return ncc[static_cast<std::size_t>(i)]; }
};

int best_of(const Scores& scores) {
  const auto end = scores.ncc.begin() + scores.count;
  return static_cast<int>(std::max_element(scores.ncc.begin(), end) - scores.ncc.begin());
}

// A local maximum between whole steps: top of the parabola through a score and its neighbours.
struct Peak {
  float offset = 0;
  float ncc = 0;
};
Peak peak_at(const Scores& scores, int i) {
  if (i == 0 || i + 1 >= scores.count) return {0, scores.at(i)};
  const float before = scores.at(i - 1);
  const float after = scores.at(i + 1);
  const float bend = before - 2 * scores.at(i) + after;
  if (!(bend < -1e-6F)) return {0, scores.at(i)};
  const float offset = std::clamp(0.5F * (before - after) / bend, -0.5F, 0.5F);
  return {offset, std::min(1.0F, scores.at(i) - 0.25F * (before - after) * offset)};
}

// Best top outside the peak; flanks of the peak that still rise towards it do not count.
float rival_of(const Scores& scores, int best) {
  float rival = -1;
  for (int i = 0; i < scores.count; ++i) {
    if (std::abs(i - best) <= kPeakReach) continue;
    const bool above_left = i == 0 || scores.at(i) >= scores.at(i - 1);
    const bool above_right = i + 1 == scores.count || scores.at(i) >= scores.at(i + 1);
    if (above_left && above_right) rival = std::max(rival, peak_at(scores, i).ncc);
  }
  return rival;
}

}  // namespace

const char* to_text(StereoOutcome outcome) {
  switch (outcome) {
    case StereoOutcome::ok:
      return "ok";
    case StereoOutcome::no_match:
      return "no_match";
    case StereoOutcome::ambiguous:
      return "ambiguous";
    case StereoOutcome::inconsistent:
      return "inconsistent";
    case StereoOutcome::out_of_image:
      return "out_of_image";
  }
  return "unknown";
}

StereoMatcher::StereoMatcher(const StereoMatchConfig& config, const Klt& klt) : config_(config), klt_(klt) {
  PELORUS_CHECK(config.max_disparity_px >= config.min_disparity_px, "disparity range is empty");
  PELORUS_CHECK(config.search_level >= 0 && config.search_level < ImagePyramid::kMaxLevels, "bad search level");
  PELORUS_CHECK(config.search_half_window_px >= 2 && 2 * config.search_half_window_px + 1 <= kPatchMaxSize,
                "stereo half window must be 2..7 px");
  const float span = (config.max_disparity_px - config.min_disparity_px) / std::ldexp(1.0F, config.search_level);
  PELORUS_CHECK(span + 2 < kMaxCandidates, "disparity range too long for the search level");
}

StereoMatcher::Found StereoMatcher::search_row(const ImagePyramid& from, const ImagePyramid& to, float u_px, float v_px,
                                               int direction) const {
  const int level = std::min({config_.search_level, from.levels() - 1, to.levels() - 1});
  const ImageView& image = from.level(level);
  const ImageView& other = to.level(level);
  const float scale = std::ldexp(1.0F, -level);
  const float u = u_px * scale;
  const float v = v_px * scale;
  const auto last_u = static_cast<float>(image.width - 1);
  if (!(u >= 0 && v >= 0 && u <= last_u && v <= static_cast<float>(image.height - 1))) {
    return {StereoOutcome::out_of_image, 0, 0};
  }
  PatchTemplate patch;
  patch.size = 2 * config_.search_half_window_px + 1;
  const auto half = static_cast<float>(config_.search_half_window_px);
  set_mask(patch, overlap(u - half, patch.size, image.width), overlap(v - half, patch.size, image.height));
  sample_patch(image, u - half, v - half, patch);
  normalise(patch);
  const float min_eigenvalue = klt_.config().min_eigenvalue;
  if (patch.structure_uu < min_eigenvalue * patch.count) return {StereoOutcome::no_match, 0, 0};

  // Whole steps from the point itself: both patches then fall between pixels alike.
  const auto sign = static_cast<float>(-direction);
  const float first = std::floor(config_.min_disparity_px * scale);
  const float last = std::ceil(config_.max_disparity_px * scale);
  Scores scores;
  for (float d = first; d <= last && scores.count < kMaxCandidates; d += 1.0F) {
    const float at = u + sign * d;
    if (at < 0 || at > last_u) {
      if (scores.count == 0 && at > last_u) continue;  // a negative disparity that leaves the image on this side
      break;
    }
    const PatchSums sums = compare_patch(other, at - half, v - half, patch);
    scores.ncc[static_cast<std::size_t>(scores.count++)] = fit_of(patch, sums).ncc;
  }
  if (scores.count == 0) return {StereoOutcome::out_of_image, 0, 0};
  const int best = best_of(scores);
  const Peak peak = peak_at(scores, best);
  const float disparity = first + static_cast<float>(best) + peak.offset;
  Found found{StereoOutcome::ok, (u + sign * disparity) / scale, peak.ncc};
  if (peak.ncc < config_.min_ncc) {
    found.outcome = StereoOutcome::no_match;
  } else if (1 - peak.ncc + kLossFloor > config_.max_rival_ratio * (1 - rival_of(scores, best) + kLossFloor)) {
    found.outcome = StereoOutcome::ambiguous;
  }
  return found;
}

StereoMatcher::Found StereoMatcher::refine(const ImagePyramid& from, const ImagePyramid& to, float u_px, float v_px,
                                           float u_predicted_px) const {
  KltTask task;
  task.u_from_px = u_px;
  task.v_from_px = task.v_to_px = v_px;
  task.u_to_px = u_predicted_px;
  klt_.track(from, to, {&task, 1}, KltSearch::slanted_row, config_.search_level, true);
  if (task.outcome == KltOutcome::out_of_image) return {StereoOutcome::out_of_image, 0, 0};
  // A new point has to be exact: an answer of a coarser level is none.
  if (task.outcome != KltOutcome::ok || task.level != 0) return {StereoOutcome::no_match, 0, task.ncc};
  return {StereoOutcome::ok, task.u_to_px, task.ncc, task.warp};
}

StereoMatcher::Found StereoMatcher::there(const ImagePyramid& from, const ImagePyramid& to, float u_px, float v_px,
                                          int direction) const {
  const Found coarse = search_row(from, to, u_px, v_px, direction);
  if (coarse.outcome != StereoOutcome::ok) return coarse;
  return refine(from, to, u_px, v_px, coarse.u_px);
}

void StereoMatcher::match(const ImagePyramid& left, const ImagePyramid& right, std::span<StereoTask> tasks) const {
  for (StereoTask& task : tasks) {
    const Found partner = there(left, right, task.u_left_px, task.v_px, 1);
    task.ncc = partner.ncc;
    task.outcome = partner.outcome;
    if (partner.outcome != StereoOutcome::ok) continue;
    const float disparity = task.u_left_px - partner.u_px;
    if (disparity < config_.min_disparity_px || disparity > config_.max_disparity_px) {
      task.outcome = StereoOutcome::no_match;
      continue;
    }
    const Found back = there(right, left, partner.u_px, task.v_px, -1);
    if (back.outcome != StereoOutcome::ok || std::abs(back.u_px - task.u_left_px) > config_.max_return_px) {
      task.outcome = StereoOutcome::inconsistent;
      continue;
    }
    task.u_right_px = partner.u_px;
    task.warp = partner.warp;
  }
}

}  // namespace pelorus
