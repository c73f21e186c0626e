// Registry's judgement of lives: evidence and confirmation, coasting, merging. Part of Registry (registry.h).

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/fixed_vector.h"
#include "core/geometry/hull.h"
#include "core/motion/stereo_transfer.h"
#include "core/objects/registry.h"
#include "core/objects/spread.h"

namespace pelorus {

// Displacement since birth, in deviations, in pixels and against the camera's own: beyond noise, and beyond any
// systematic error of matching and calibration.
bool Registry::moved_significantly(const StereoRig& rig, const WorldStep& world, const MovingBody& body) const {
  const Eigen::Vector3d p_now_world = body.T_world_obj.translation();
  const Eigen::Vector3d moved_world = p_now_world - body.birth_centroid_world;
  const double ego_m = (world.T_world_curr.translation() - body.birth_camera_world).norm();
  const double haste =
      std::max(1.0, static_cast<double>(config_.confirm_ego_frames) / std::max(1, body.frames_measured));
  if (moved_world.norm() < haste * config_.confirm_ego_share * ego_m) return false;
  const Rigid3 T_cam_world = world.T_world_curr.inverse();
  const Eigen::Vector3d p_now = T_cam_world * p_now_world;
  const Eigen::Vector3d p_then = T_cam_world * body.birth_centroid_world;
  if (!(p_now.z() > 0.05) || !(p_then.z() > 0.05)) return false;
  if ((rig.project(p_now) - rig.project(p_then)).norm() < config_.confirm_move_px) return false;
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -skew(p_now_world);
  const Eigen::Matrix3d cov = J * body.cov_T_world_obj * J.transpose() + 1e-12 * Eigen::Matrix3d::Identity();
  return moved_world.dot(cov.ldlt().solve(moved_world)) > config_.confirm_sigmas * config_.confirm_sigmas;
}

// A small group on or beside a confirmed body is a part of it that bends (a cyclist's leg), not a second object.
bool Registry::part_of_another(const MovingBody& body) const {
  const Eigen::Vector3d center = body.T_world_obj * body.centroid_obj;
  return std::any_of(bodies_.begin(), bodies_.end(), [&](const MovingBody& other) {
    if (other.id == body.id || other.phase == ObjectPhase::tentative || !other.measured) return false;
    if (body.members.size() >= other.members.size()) return false;
    FixedVector<Eigen::Vector3d, kMaxPoints> hull;
    for (const ModelPoint& point : other.model) hull.push_back(point.p_obj);
    return distance_to_hull(hull, other.T_world_obj.inverse() * center) <
           config_.part_reach_share * other.extent_m.norm();
  });
}

// Whether it had as many frames and points as confirmation takes, `times` over.
bool Registry::supported(const MovingBody& body, int times) const {
  const auto frames = static_cast<std::ptrdiff_t>(body.frames_measured);
  const std::ptrdiff_t points = std::ssize(body.members);
  return frames >= std::ptrdiff_t{times} * config_.confirm_frames &&
         frames * points * points >= std::ptrdiff_t{times} * config_.confirm_support;
}

// Likelihood of the body's own motion against "it is static" (Wedel et al. 2009), summed over points and frames.
void Registry::weigh_evidence(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                              std::span<const double> chi2_static, const WorldStep& world, MovingBody& body) const {
  for (const PointIndex i : body.members) {
    const auto place = static_cast<std::size_t>(i);
    const double ratio = 0.5 * (chi2_static[place] - transfer_chi2(rig, body.H_curr_prev, pairs[place]));
    body.evidence += std::clamp(ratio, -config_.evidence_cap, config_.evidence_cap);
  }
  if (body.phase != ObjectPhase::tentative) return;
  if (static_inside(pairs, roles, body.members) > config_.max_static_inside) {
    body.phase = ObjectPhase::ended;
    body.measured = false;
    return;
  }
  const bool enough = supported(body, 1) && static_cast<int>(body.members.size()) >= config_.confirm_points &&
                      spread_px(pairs, body.members) >= config_.min_spread_px;
  if (enough && body.evidence > config_.confirm_evidence && moved_significantly(rig, world, body) &&
      !part_of_another(body)) {
    body.phase = ObjectPhase::confirmed;
  }
}

// Extrapolation with growing covariance (white-noise acceleration); a tentative body is given up soon.
void Registry::coast(const WorldStep& world, MovingBody& body) const {
  ++body.frames_missed;
  if (body.phase == ObjectPhase::tentative) {
    if (body.frames_missed > config_.tentative_patience_frames) body.phase = ObjectPhase::ended;
  } else {
    // No longer than it had been in sight: a short acquaintance foretells little.
    const double seen_s = seconds(body.last_seen - body.first_seen);
    const double away_s = seconds(world.time - body.last_seen);
    body.phase = away_s > std::min(config_.coast_s, seen_s) ? ObjectPhase::ended : ObjectPhase::coasting;
  }
  const Rigid3 before = body.T_world_obj;
  body.T_world_obj = before * se3_exp(body.twist_obj * world.dt_s);
  body.M_world = body.T_world_obj * before.inverse();
  body.T_cam_obj = world.T_world_curr.inverse() * body.T_world_obj;
  const double missing_s = seconds(world.time - body.last_seen);
  const double grown_m = config_.sigma_acceleration_mps2 * std::pow(missing_s, 1.5);
  const double grown_rad = config_.sigma_acceleration_radps2 * std::pow(missing_s, 1.5);
  Matrix6d growth = Matrix6d::Zero();
  growth.topLeftCorner<3, 3>().diagonal().setConstant(grown_m * grown_m * world.dt_s / std::max(missing_s, 1e-3));
  growth.bottomRightCorner<3, 3>().diagonal().setConstant(grown_rad * grown_rad * world.dt_s /
                                                          std::max(missing_s, 1e-3));
  const Matrix6d grown = transported(body.T_world_obj, growth);
  body.cov_steps += grown;
  body.cov_T_world_obj += grown;
  body.cov_M_world += grown;
}

// A body whose points stand apart for some frames gives up all but the largest part; the rest find their own way as
// new bodies.
void Registry::split_apart(const StereoRig& rig, PointPairs pairs, std::span<BodyId> owner) {
  const std::size_t known = bodies_.size();
  for (std::size_t b = 0; b < known; ++b) {
    MovingBody& body = bodies_[b];
    part_.resize(body.members.size());
    const int parts = separate_parts(rig, pairs, body.members, config_.clusters, part_);
    const auto second = std::count(part_.begin(), part_.end(), 1);
    const bool apart = parts > 1 && second >= std::ptrdiff_t{2} * config_.min_points &&
                       std::ptrdiff_t{4} * second >= std::ssize(part_);
    body.frames_apart = apart ? body.frames_apart + 1 : 0;
    if (body.frames_apart < config_.split_frames) continue;
    std::size_t kept = 0;
    for (std::size_t m = 0; m < part_.size(); ++m) {
      if (part_[m] == 0) {
        body.members[kept++] = body.members[m];
      } else {
        owner[static_cast<std::size_t>(body.members[m])] = kNoBody;
      }
    }
    body.members.resize(kept);
    // What it gave up is no part of its shape any more, else the hull would claim it back in the next step.
    std::erase_if(body.model, [&](const ModelPoint& point) {
      return std::none_of(body.members.begin(), body.members.end(),
                          [&](PointIndex i) { return pairs[static_cast<std::size_t>(i)].track == point.track; });
    });
    body.extent_m.setZero();
    body.frames_apart = 0;
  }
}

void Registry::merge_alike(PointPairs pairs, std::span<BodyId> owner) {
  for (std::size_t a = 0; a < bodies_.size(); ++a) {
    for (std::size_t b = a + 1; b < bodies_.size(); ++b) {
      // The elder stays, but never a tentative one in place of a confirmed one.
      const bool swapped = bodies_[a].phase == ObjectPhase::tentative && bodies_[b].phase != ObjectPhase::tentative;
      MovingBody& older = bodies_[swapped ? b : a];
      MovingBody& younger = bodies_[swapped ? a : b];
      if (older.phase == ObjectPhase::ended || younger.phase == ObjectPhase::ended) continue;
      const std::array<std::int32_t, 2> ids{older.id.value, younger.id.value};
      auto entry =
          std::find_if(alike_.begin(), alike_.end(), [&](const auto& e) { return e[0] == ids[0] && e[1] == ids[1]; });
      const bool alike = older.measured && younger.measured && motion_mismatch(older, younger) < merge_.gate_chi2 &&
                         touching(pairs, older, younger, merge_);
      if (!alike) {
        if (entry != alike_.end()) alike_.erase(entry);
        continue;
      }
      if (entry == alike_.end()) entry = alike_.insert(alike_.end(), {ids[0], ids[1], 0});
      const int needed = younger.phase == ObjectPhase::tentative ? 1 : merge_.agreeing_frames;
      if (++(*entry)[2] < needed) continue;
      for (const PointIndex i : younger.members) {
        older.members.push_back(i);
        owner[static_cast<std::size_t>(i)] = older.id;
      }
      older.evidence += younger.evidence;
      younger.members.clear();
      younger.measured = false;
      younger.phase = ObjectPhase::ended;
    }
  }
}

void Registry::release(const MovingBody& body, std::span<BodyId> owner) const {
  for (BodyId& id : owner) {
    if (id == body.id) id = kNoBody;
  }
}

}  // namespace pelorus
