#include "core/objects/registry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/motion/stereo_transfer.h"
#include "core/objects/spread.h"

namespace pelorus {
namespace {

const PointPair& at(PointPairs pairs, PointIndex i) { return pairs[static_cast<std::size_t>(i)]; }

// Componentwise median: a mismatch far away does not move it.
Eigen::Vector3d robust_centroid(std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  const auto middle = static_cast<std::ptrdiff_t>(points.size() / 2);
  for (int axis = 0; axis < 3; ++axis) {
    std::nth_element(points.begin(), points.begin() + middle, points.end(),
                     [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    centroid[axis] = points[static_cast<std::size_t>(middle)][axis];
  }
  return centroid;
}

// The model's entry for a track: a new one takes the place of the longest unseen when the model is full.
ModelPoint& model_entry(std::vector<ModelPoint>& model, TrackId id, const Track& track, int capacity) {
  const auto known = std::find_if(model.begin(), model.end(), [&](const ModelPoint& m) { return m.track == id; });
  if (known != model.end()) return *known;
  ModelPoint* entry = nullptr;
  if (static_cast<int>(model.size()) >= capacity) {
    entry = &*std::min_element(model.begin(), model.end(),
                               [](const ModelPoint& a, const ModelPoint& b) { return a.last_frame < b.last_frame; });
  } else {
    entry = &model.emplace_back();
  }
  entry->track = id;
  entry->descriptor = track.descriptor;
  entry->laplacian = track.laplacian;
  entry->has_descriptor = track.has_descriptor;
  return *entry;
}

}  // namespace

Registry::Registry(const RegistryConfig& config, const MembershipConfig& membership, const IdentityConfig& identity,
                   const MergeConfig& merge, const ReidentificationConfig& reidentification,
                   const BodyWindowConfig& window, const TwoFrameBaConfig& ba, int capacity)
    : config_(config),
      membership_(membership, ba, capacity),
      identity_(identity),
      merge_(merge),
      reidentification_(reidentification),
      window_config_(window),
      two_frame_ba_(ba, capacity) {
  bodies_.reserve(kMaxObjects);
  observations_.reserve(static_cast<std::size_t>(capacity));
}

void Registry::predict(const Rigid3& T_world_prev, const Rigid3& T_world_curr, double dt_s) {
  for (MovingBody& body : bodies_) {
    const Rigid3 T_world_obj = body.T_world_obj * se3_exp(body.twist_obj * dt_s);
    body.H_curr_prev = T_world_curr.inverse() * T_world_obj * body.T_world_obj.inverse() * T_world_prev;
    body.T_cam_obj = T_world_prev.inverse() * body.T_world_obj;  // at the previous frame, in its final camera pose
    body.measured = false;
    body.members.clear();
  }
}

void Registry::claim(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                     std::span<const double> chi2_static, const WorldStep& world, const RegistrySteps& steps,
                     std::span<BodyId> owner) {
  ++step_;
  for (MovingBody& body : bodies_) {
    const auto seed = world.seed * 1024 + static_cast<std::uint64_t>(body.id.value);
    body.measured =
        membership_.run(rig, pairs, roles, chi2_static, steps.hull_membership, seed, body, owner) == StageOutcome::ok;
  }
}

void Registry::adopt(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles, const Partition& groups,
                     std::span<const Track* const> track_of_pair, const WorldStep& world, const RegistrySteps& steps,
                     std::span<BodyId> owner) {
  T_cam_obj_expected_.clear();
  for (const MovingBody& body : bodies_) {
    T_cam_obj_expected_.push_back(world.T_world_curr.inverse() * body.T_world_obj *
                                  se3_exp(body.twist_obj * world.dt_s));
  }
  if (steps.merge) split_apart(rig, pairs, owner);
  const std::size_t known = bodies_.size();
  Group part_group;
  for (const Group& group : groups.groups) {
    part_.resize(group.members.size());
    const int parts = steps.merge ? separate_parts(rig, pairs, group.members, config_.clusters, part_) : 1;
    if (!steps.merge) std::fill(part_.begin(), part_.end(), 0);
    const auto size_of = [&](int p) { return static_cast<double>(std::count(part_.begin(), part_.end(), p)); };
    double in_bodies = 0;
    for (int p = 0; p < parts && size_of(p) >= config_.min_points; ++p) in_bodies += size_of(p);
    const auto all = static_cast<double>(group.members.size());
    // Points scattered over the scene that happen to agree fall into crumbs; bodies hold most of their group.
    if (static_inside(pairs, roles, group.members) > config_.max_static_inside) continue;
    const int adopted = in_bodies >= config_.min_share_in_parts * all  ? parts
                        : size_of(0) >= config_.min_share_of_one * all ? 1
                                                                       : 0;
    for (int p = 0; p < adopted && size_of(p) >= config_.min_points; ++p) {
      part_group = group;
      std::size_t kept = 0;
      for (std::size_t m = 0; m < group.members.size(); ++m) {
        if (part_[m] == p) part_group.members[kept++] = group.members[m];
      }
      part_group.members.resize(kept);
      adopt_group(rig, pairs, roles, part_group, track_of_pair, world, steps, known, owner);
    }
  }
}

// Identity with a body in sight, else recognition of one that was out of sight, else a birth (paper 5.2.4).
void Registry::adopt_group(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles, const Group& group,
                           std::span<const Track* const> track_of_pair, const WorldStep& world,
                           const RegistrySteps& steps, std::size_t known, std::span<BodyId> owner) {
  const std::span<const MovingBody> earlier(bodies_.data(), known);
  if (steps.identity_mismatch) {
    const IdentityMatch match = identify(rig, pairs, group, earlier, identity_);
    if (match.body >= 0) {
      MovingBody& body = bodies_[static_cast<std::size_t>(match.body)];
      for (const PointIndex i : group.members) {
        if (transfer_chi2(rig, body.H_curr_prev, at(pairs, i)) > kChi2_3dof_999) continue;
        body.members.push_back(i);
        owner[static_cast<std::size_t>(i)] = body.id;
      }
      return;
    }
  }
  if (steps.reidentification) {
    const Reidentified found = reidentify(rig, pairs, group, track_of_pair, earlier, T_cam_obj_expected_, world.time,
                                          world.seed, reidentification_);
    if (found.body >= 0) {
      resume(rig, pairs, group, found, world, owner);
      return;
    }
  }
  if (spread_px(pairs, group.members) < config_.min_spread_px) return;
  if (static_inside(pairs, roles, group.members) > config_.max_static_inside) return;
  if (static_cast<int>(bodies_.size()) < kMaxObjects) give_birth(rig, pairs, group, world, owner);
}

// Paper section 4: the frame of the object is fixed at its birth b; here with axes parallel to the world's.
void Registry::give_birth(const StereoRig& rig, PointPairs pairs, const Group& group, const WorldStep& world,
                          std::span<BodyId> owner) {
  MovingBody body(window_config_);
  body.id = BodyId{next_id_++};
  body.first_seen = world.time;
  body.members = group.members;
  body.H_curr_prev = group.H_curr_prev;
  body.measured = true;
  std::vector<Eigen::Vector3d> p_world;
  for (const PointIndex i : group.members) {
    p_world.push_back(world.T_world_prev * at(pairs, i).prev.p_cam);
    owner[static_cast<std::size_t>(i)] = body.id;
  }
  body.T_world_obj = Rigid3::Identity();
  body.T_world_obj.translation() = robust_centroid(p_world);
  body.birth_centroid_world = body.T_world_obj.translation();
  body.T_cam_obj = world.T_world_prev.inverse() * body.T_world_obj;
  observations_.clear();
  for (const PointIndex i : group.members) {
    observations_.push_back({at(pairs, i).track, at(pairs, i).prev.z_px, at(pairs, i).sigma_px});
  }
  const auto dt = Duration(static_cast<std::int64_t>(-world.dt_s * 1e9));
  body.window.add_frame(rig, world.time + dt, body.T_cam_obj, world.T_world_prev, observations_);
  bodies_.push_back(std::move(body));
}

// The body is back: its pose comes from the matches, its window starts anew in the same frame.
void Registry::resume(const StereoRig& rig, PointPairs pairs, const Group& group, const Reidentified& found,
                      const WorldStep& world, std::span<BodyId> owner) {
  MovingBody& body = bodies_[static_cast<std::size_t>(found.body)];
  body.members = group.members;
  body.H_curr_prev = group.H_curr_prev;
  body.T_cam_obj = group.H_curr_prev.inverse() * found.T_cam_obj;  // at the previous frame
  body.T_world_obj = world.T_world_prev * body.T_cam_obj;
  body.measured = true;
  body.window.clear();
  observations_.clear();
  for (const PointIndex i : group.members) {
    owner[static_cast<std::size_t>(i)] = body.id;
    observations_.push_back({at(pairs, i).track, at(pairs, i).prev.z_px, at(pairs, i).sigma_px});
  }
  const auto dt = Duration(static_cast<std::int64_t>(-world.dt_s * 1e9));
  body.window.add_frame(rig, world.time + dt, body.T_cam_obj, world.T_world_prev, observations_);
}

void Registry::settle(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                      std::span<const double> chi2_static, std::span<const Track* const> track_of_pair,
                      const WorldStep& world, const RegistrySteps& steps, std::span<BodyId> owner) {
  for (MovingBody& body : bodies_) {
    if (body.measured) {
      std::sort(body.members.begin(), body.members.end());
      measure(rig, pairs, track_of_pair, world, steps, body);
      weigh_evidence(rig, pairs, roles, chi2_static, world, body);
    } else {
      coast(world, body);
    }
  }
  if (steps.merge) merge_alike(pairs, owner);
  std::erase_if(bodies_, [&](const MovingBody& body) {
    const bool over = body.phase == ObjectPhase::ended;
    if (over) release(body, owner);
    return over;
  });
}

void Registry::measure(const StereoRig& rig, PointPairs pairs, std::span<const Track* const> track_of_pair,
                       const WorldStep& world, const RegistrySteps& steps, MovingBody& body) {
  const MotionFit fit = two_frame_ba_.run(rig, pairs, body.members, body.H_curr_prev);
  if (fit.outcome != StageOutcome::degenerate && fit.outcome != StageOutcome::too_few_points) {
    body.H_curr_prev = fit.H_curr_prev;
  }
  Rigid3 H_curr_prev = body.H_curr_prev;
  Matrix6d cov_H = fit.cov_H;
  Rigid3 T_cam_obj = body.H_curr_prev * body.T_cam_obj;
  observations_.clear();
  for (const PointIndex i : body.members) {
    observations_.push_back({at(pairs, i).track, at(pairs, i).curr.z_px, at(pairs, i).sigma_px});
  }
  body.window.add_frame(rig, world.time, T_cam_obj, world.T_world_curr, observations_);
  Matrix6d cov_T_cam_obj = cov_H;
  if (steps.object_window && body.window.adjust(rig) == StageOutcome::ok) {
    T_cam_obj = body.window.T_cam_body();
    H_curr_prev = T_cam_obj * body.window.T_cam_body_previous().inverse();
    cov_T_cam_obj = body.window.cov_T_cam_body();
    cov_H = body.window.cov_H_curr_prev();
  }
  const Rigid3 T_world_obj_before = body.T_world_obj;
  body.T_cam_obj = T_cam_obj;
  body.T_world_obj = orthonormalized(world.T_world_curr * T_cam_obj);
  // M_world = T_world_curr * H * T_prev_world (method section 1, in place of the paper's eq. 2).
  body.M_world = world.T_world_curr * H_curr_prev * world.T_world_prev.inverse();
  const Matrix6d Ad = adjoint(world.T_world_curr);
  body.cov_M_world = Ad * (cov_H + world.cov_H_static) * Ad.transpose();
  body.cov_T_world_obj = Ad * cov_T_cam_obj * Ad.transpose();
  const Rigid3 step_obj = T_world_obj_before.inverse() * body.M_world * T_world_obj_before;
  const Vector6d twist = se3_log(step_obj) / world.dt_s;
  const double blend = body.frames_measured == 0 ? 1.0 : 0.6;
  body.twist_obj += blend * (twist - body.twist_obj);
  remember_points(pairs, track_of_pair, body);
  ++body.frames_measured;
  body.frames_missed = 0;
  body.last_seen = world.time;
  if (body.phase == ObjectPhase::coasting) body.phase = ObjectPhase::confirmed;
}

void Registry::remember_points(PointPairs pairs, std::span<const Track* const> track_of_pair, MovingBody& body) {
  const Rigid3 T_obj_cam = body.T_cam_obj.inverse();
  std::vector<Eigen::Vector3d> p_obj;
  for (const PointIndex i : body.members) {
    const PointPair& pair = at(pairs, i);
    const BodyPoint* refined = body.window.find(pair.track);
    const Eigen::Vector3d p = refined != nullptr ? refined->p_body : Eigen::Vector3d(T_obj_cam * pair.curr.p_cam);
    p_obj.push_back(p);
    const Track& track = *track_of_pair[static_cast<std::size_t>(i)];
    ModelPoint& known = model_entry(body.model, pair.track, track, config_.max_model_points);
    known.p_obj = p;
    known.last_frame = step_;
  }
  Eigen::AlignedBox3d box;
  for (const auto& p : p_obj) box.extend(p);
  body.extent_m = body.extent_m.cwiseMax(box.sizes()) * 0.98 + 0.02 * box.sizes();
  body.centroid_obj = robust_centroid(p_obj);
}

}  // namespace pelorus
