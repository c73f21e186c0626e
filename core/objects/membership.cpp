#include "core/objects/membership.h"

#include <algorithm>

#include "core/geometry/hull.h"
#include "core/motion/stereo_transfer.h"

namespace pelorus {
namespace {

double explained(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> points, const Rigid3& H,
                 double gate_chi2) {
  double score = 0;
  for (const PointIndex i : points) {
    score += std::max(0.0, gate_chi2 - transfer_chi2(rig, H, pairs[static_cast<std::size_t>(i)]));
  }
  return score;
}

}  // namespace

Membership::Membership(const MembershipConfig& config, const TwoFrameBaConfig& ba, int capacity)
    : config_(config), two_frame_ba_(ba, capacity) {
  candidates_.reserve(static_cast<std::size_t>(capacity));
  hull_points_.reserve(static_cast<std::size_t>(capacity) + kMaxPoints);  // former members and the model
  proposal_points_.reserve(static_cast<std::size_t>(capacity));
}

// The hull is taken at the previous position, where the body's pose is known: its image there is the paper's
// g(i-1,i)^(k,i), the group of points assigned to the group of the step before.
void Membership::collect_candidates(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                                    bool by_hull, const MovingBody& body, std::span<const BodyId> owner) {
  candidates_.clear();
  hull_points_.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].previous_body != body.id || owner[i] != kNoBody) continue;
    candidates_.push_back(static_cast<PointIndex>(i));
    hull_points_.push_back(pairs[i].prev.p_cam);
  }
  former_ = candidates_.size();
  // Out of sight for longer it comes back by recognition, which tells its pose.
  if (!by_hull || body.frames_missed > config_.hull_missed_frames) return;
  for (const ModelPoint& point : body.model) hull_points_.push_back(body.T_cam_obj * point.p_obj);
  const Eigen::Vector3d center = body.T_cam_obj * body.centroid_obj;
  const double margin_m = config_.hull_margin_share * body.extent_m.norm();
  const double reach_m = margin_m + body.extent_m.norm();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool open = owner[i] == kNoBody && pairs[i].previous_body != body.id && roles[i] == PointRole::moving;
    if (!open) continue;
    const Eigen::Vector3d& p_prev = pairs[i].prev.p_cam;
    const double sigma_m = rig.depth_sigma_m(p_prev.z(), pairs[i].sigma_px * 1.5);
    if ((p_prev - center).norm() > reach_m + 3 * sigma_m) continue;
    if (distance_to_hull(hull_points_, p_prev) < margin_m + 3 * sigma_m) {
      candidates_.push_back(static_cast<PointIndex>(i));
    }
  }
}

StageOutcome Membership::run(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                             std::span<const double> chi2_static, bool by_hull, std::uint64_t seed, MovingBody& body,
                             std::span<BodyId> owner) {
  body.members.clear();
  collect_candidates(rig, pairs, roles, by_hull, body, owner);
  if (static_cast<int>(candidates_.size()) < config_.min_points) return StageOutcome::too_few_points;

  // Former members decide the motion while there are enough of them: another body that crosses the hull with more
  // points would otherwise take this one over.
  const bool enough = former_ >= static_cast<std::size_t>(config_.min_points);
  const auto deciding = std::span<const PointIndex>(candidates_).first(enough ? former_ : candidates_.size());
  Rigid3 H_start = body.H_curr_prev;
  const auto fresh = propose_motion(rig, pairs, deciding, seed, config_.proposal, proposal_points_);
  if (fresh && explained(rig, pairs, deciding, *fresh, config_.gate_chi2) >
                   explained(rig, pairs, deciding, H_start, config_.gate_chi2)) {
    H_start = *fresh;
  }
  const MotionFit fit = two_frame_ba_.run(rig, pairs, candidates_, H_start);
  if (fit.outcome == StageOutcome::degenerate || fit.support < config_.min_points) return StageOutcome::no_agreement;
  for (const PointIndex i : candidates_) {
    const auto place = static_cast<std::size_t>(i);
    const double chi2 = transfer_chi2(rig, fit.H_curr_prev, pairs[place]);
    // A point that the static scene explains clearly better over its history has left the body.
    const bool rather_static = chi2_static[place] + 6.0 < chi2 && roles[place] == PointRole::fixed;
    if (chi2 >= config_.gate_chi2 || rather_static) continue;
    body.members.push_back(i);
    owner[place] = body.id;
  }
  if (static_cast<int>(body.members.size()) >= config_.min_points) {
    body.H_curr_prev = fit.H_curr_prev;
    return StageOutcome::ok;
  }
  for (const PointIndex i : body.members) owner[static_cast<std::size_t>(i)] = kNoBody;
  body.members.clear();
  return StageOutcome::too_few_points;
}

}  // namespace pelorus
