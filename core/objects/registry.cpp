#include "core/objects/registry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/base/fixed_vector.h"
#include "core/motion/stereo_transfer.h"
#include "core/objects/spread.h"

namespace pelorus {
namespace {

constexpr int kLeastShared = 3;  // points that tie two poses

const PointPair& at(PointPairs pairs, PointIndex i) { return pairs[static_cast<std::size_t>(i)]; }

// The model's entry for a track: a new one takes the place of the longest unseen when the model is full; while the
// frame of the body's birth is looked for, that of one that tells nothing of it.
ModelPoint& model_entry(MovingBody& body, TrackId id, const Track& track, int capacity) {
  std::vector<ModelPoint>& model = body.model;
  const auto known = std::find_if(model.begin(), model.end(), [&](const ModelPoint& m) { return m.track == id; });
  if (known != model.end()) return *known;
  ModelPoint* entry = nullptr;
  if (static_cast<int>(model.size()) >= capacity) {
    const bool looking = body.recoveries_left > 0;
    entry = &*std::min_element(model.begin(), model.end(), [&](const ModelPoint& a, const ModelPoint& b) {
      return std::pair(looking && a.of_birth, a.last_frame) < std::pair(looking && b.of_birth, b.last_frame);
    });
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
      two_frame_ba_(ba, capacity) {
  PELORUS_CHECK(config.max_model_points <= static_cast<int>(kMaxModelPoints), "registry.max_model_points is too large");
  bodies_.reserve(kMaxObjects);
  spare_.reserve(kMaxObjects);
  for (int k = 0; k < kMaxObjects; ++k) {
    MovingBody& body = spare_.emplace_back(window);
    body.members.reserve(static_cast<std::size_t>(capacity));
    body.model.reserve(static_cast<std::size_t>(config.max_model_points));
  }
  T_cam_obj_expected_.reserve(kMaxObjects);
  part_.reserve(static_cast<std::size_t>(capacity));
  part_group_.members.reserve(static_cast<std::size_t>(capacity));
  alike_.reserve(std::size_t{kMaxObjects} * kMaxObjects);
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

bool Registry::is_confirmed(BodyId id) const {
  return std::any_of(bodies_.begin(), bodies_.end(), [id](const MovingBody& body) {
    return body.id == id && (body.phase == ObjectPhase::confirmed || body.phase == ObjectPhase::coasting);
  });
}

void Registry::claim(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                     std::span<const double> chi2_static, const WorldStep& world, const RegistrySteps& steps,
                     std::span<BodyId> owner) {
  ++step_;
  births_refused_ = 0;
  for (MovingBody& body : bodies_) {
    const auto seed = world.seed * 1024 + static_cast<std::uint64_t>(body.id.value);
    body.measured = body.place_known && membership_.run(rig, pairs, roles, chi2_static, steps.hull_membership, seed,
                                                        body, owner) == StageOutcome::ok;
  }
}

void Registry::settle(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                      std::span<const double> chi2_static, std::span<const Track* const> track_of_pair,
                      const WorldStep& world, const RegistrySteps& steps, std::span<BodyId> owner) {
  for (MovingBody& body : bodies_) {
    if (body.measured) {
      std::sort(body.members.begin(), body.members.end());
      measure(rig, pairs, track_of_pair, world, steps, body);
      weigh_evidence(rig, pairs, roles, chi2_static, world, body);
    } else if (body.phase != ObjectPhase::ended) {
      coast(world, body);
    }
  }
  if (steps.merge) merge_alike(pairs, owner);
  retire_ended(owner);
}

void Registry::retire_ended(std::span<BodyId> owner) {
  for (std::size_t b = 0; b < bodies_.size();) {
    if (bodies_[b].phase != ObjectPhase::ended) {
      ++b;
      continue;
    }
    release(bodies_[b], owner);
    std::erase_if(alike_, [id = bodies_[b].id.value](const auto& e) { return e[0] == id || e[1] == id; });
    spare_.push_back(std::move(bodies_[b]));
    bodies_.erase(bodies_.begin() + static_cast<std::ptrdiff_t>(b));
  }
}

void Registry::lose() {
  for (MovingBody& body : bodies_) {
    body.phase = body.phase == ObjectPhase::tentative ? ObjectPhase::ended : ObjectPhase::coasting;
    body.measured = false;
    body.place_known = false;
    body.members.clear();
  }
  retire_ended({});
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
  if (body.frames_missed > 0 && body.window.frames() > 0) bridge_window(rig, pairs, world, body);
  observations_.clear();
  for (const PointIndex i : body.members) {
    observations_.push_back({at(pairs, i).track, at(pairs, i).curr.z_px, at(pairs, i).sigma_px});
  }
  body.window.add_frame(rig, world.time, T_cam_obj, world.T_world_curr, observations_);
  // Without the window's answer the place is as good as it was before the step, and the step's motion.
  Matrix6d cov_steps = transported(world.T_world_curr * H_curr_prev * world.T_world_prev.inverse(), body.cov_steps) +
                       transported(world.T_world_curr, cov_H);
  if (steps.object_window && body.window.adjust(rig) == StageOutcome::ok) {
    T_cam_obj = body.window.T_cam_body();
    H_curr_prev = T_cam_obj * body.window.T_cam_body_previous().inverse();
    cov_steps = transported(world.T_world_curr, body.window.cov_T_cam_body());
    cov_H = body.window.cov_H_curr_prev();
  }
  if (cov_H.isZero()) {  // neither the step nor the window could be solved: nothing was measured
    body.measured = false;
    body.members.clear();
    coast(world, body);
    return;
  }
  const Rigid3 T_world_obj_before = body.T_world_obj;
  body.T_cam_obj = T_cam_obj;
  body.T_world_obj = orthonormalized(world.T_world_curr * T_cam_obj);
  // M_world = T_world_curr * H * T_prev_world (method section 1, in place of the paper's eq. 2).
  body.M_world = world.T_world_curr * H_curr_prev * world.T_world_prev.inverse();
  body.cov_M_world = transported(world.T_world_curr, cov_H + world.cov_H_static);
  body.cov_steps = cov_steps;
  const Rigid3 step_obj = T_world_obj_before.inverse() * body.M_world * T_world_obj_before;
  const Vector6d twist = se3_log(step_obj) / world.dt_s;
  const double blend = body.frames_measured == 0 ? 1.0 : 0.6;
  body.twist_obj += blend * (twist - body.twist_obj);
  if (steps.birth_frame) recover_birth_frame(rig, pairs, track_of_pair, world, body);
  body.cov_T_world_obj = body.cov_steps + transported(body.T_world_obj, body.cov_birth_frame);
  remember_points(pairs, track_of_pair, body);
  ++body.frames_measured;
  body.frames_missed = 0;
  body.last_seen = world.time;
  if (body.phase == ObjectPhase::coasting) body.phase = ObjectPhase::confirmed;
}

// After frames without it the window's last frame is older than one step: the previous one goes in first. When none of
// the points is known to the window its frames of before would not be tied to the new ones: the body is where it was
// expected to be, and the frame of its birth is known as well as that.
void Registry::bridge_window(const StereoRig& rig, PointPairs pairs, const WorldStep& world, MovingBody& body) {
  const auto known = std::count_if(body.members.begin(), body.members.end(),
                                   [&](PointIndex i) { return body.window.find(at(pairs, i).track) != nullptr; });
  if (known < kLeastShared) {
    body.window.clear();
    expect_birth_frame(world, body);
  }
  add_previous_frame(rig, pairs, world, body);
}

// What the window has to know of the step's beginning: the pose at the previous frame, and what was seen then.
void Registry::add_previous_frame(const StereoRig& rig, PointPairs pairs, const WorldStep& world, MovingBody& body) {
  observations_.clear();
  for (const PointIndex i : body.members) {
    observations_.push_back({at(pairs, i).track, at(pairs, i).prev.z_px, at(pairs, i).sigma_px});
  }
  const auto dt = Duration(static_cast<std::int64_t>(-world.dt_s * 1e9));
  body.window.add_frame(rig, world.time + dt, body.T_cam_obj, world.T_world_prev, observations_);
}

void Registry::remember_points(PointPairs pairs, std::span<const Track* const> track_of_pair, MovingBody& body) {
  const Rigid3 T_obj_cam = body.T_cam_obj.inverse();
  FixedVector<Eigen::Vector3d, kMaxPoints> p_obj;
  for (const PointIndex i : body.members) {
    const PointPair& pair = at(pairs, i);
    const BodyPoint* refined = body.window.find(pair.track);
    const Eigen::Vector3d p = refined != nullptr ? refined->p_body : Eigen::Vector3d(T_obj_cam * pair.curr.p_cam);
    p_obj.push_back(p);
    const Track& track = *track_of_pair[static_cast<std::size_t>(i)];
    ModelPoint& known = model_entry(body, pair.track, track, config_.max_model_points);
    known.p_obj = p;
    known.last_frame = step_;
    known.of_birth = frame_is_of_birth(body);
  }
  Eigen::AlignedBox3d box;
  for (const auto& p : p_obj) box.extend(p);
  body.extent_m = body.extent_m.cwiseMax(box.sizes()) * 0.98 + 0.02 * box.sizes();
  body.centroid_obj = robust_centroid(p_obj);
}

}  // namespace pelorus
