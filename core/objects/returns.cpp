// Registry's dealing with bodies that were out of sight: recognition, and the frame of their birth. Part of Registry.

#include <algorithm>

#include "core/objects/registry.h"

namespace pelorus {
namespace {

constexpr int kRecoveries = 100;        // tries after each return, one a step
constexpr double kClearlyBetter = 0.6;  // of a variance

// How well a frame is known: variance of its axes' directions, and of its origin.
double turn_variance(const Matrix6d& cov) { return cov.bottomRightCorner<3, 3>().trace(); }
double place_variance(const Matrix6d& cov) { return cov.topLeftCorner<3, 3>().trace(); }

}  // namespace

// A body that comes back shows too little at first to be recognised and is taken for a new one: looked at again as more
// of it shows, until it is confirmed.
void Registry::recognise_tentative(const StereoRig& rig, PointPairs pairs, std::span<const Track* const> track_of_pair,
                                   const WorldStep& world, std::span<BodyId> owner) {
  Group& group = part_group_;
  for (MovingBody& body : bodies_) {
    if (body.phase != ObjectPhase::tentative || !body.measured) continue;
    group.members = body.members;
    group.H_curr_prev = body.H_curr_prev;
    Reidentified found = reidentify(rig, pairs, group, track_of_pair, bodies_, T_cam_obj_expected_, world.time,
                                    world.seed, reidentification_);
    if (found.body < 0 && body.frames_measured + 1 >= config_.confirm_frames) {
      found = recognise_motion(rig, pairs, group, bodies_, T_cam_obj_expected_,
                               world.T_world_curr.inverse() * world.T_world_prev, world.time, reidentification_);
    }
    if (found.body < 0) continue;
    body.members.clear();
    body.measured = false;
    body.phase = ObjectPhase::ended;
    resume(rig, pairs, group, found, world, owner);
  }
}

// The body is back: its pose comes from the matches or is the expected one, its window starts anew in the same frame.
void Registry::resume(const StereoRig& rig, PointPairs pairs, const Group& group, const Reidentified& found,
                      const WorldStep& world, std::span<BodyId> owner) {
  MovingBody& body = bodies_[static_cast<std::size_t>(found.body)];
  body.members = group.members;
  body.H_curr_prev = group.H_curr_prev;
  body.T_cam_obj = group.H_curr_prev.inverse() * found.placing.T_cam_obj;  // at the previous frame
  body.T_world_obj = world.T_world_prev * body.T_cam_obj;
  // The model may hold points of a guessed frame; those that matched are known no better than that.
  body.cov_birth_frame =
      found.placing.matches > 0 ? Matrix6d(body.cov_birth_frame + found.placing.cov_obj) : found.placing.cov_obj;
  body.cov_steps.setZero();
  body.recoveries_left = kRecoveries;
  body.measured = true;
  body.place_known = true;
  body.window.clear();
  for (const PointIndex i : group.members) owner[static_cast<std::size_t>(i)] = body.id;
  body.frames_missed = 0;  // the window starts anew, at the previous frame
  add_previous_frame(rig, pairs, world, body);
}

void Registry::expect_birth_frame(const WorldStep& world, MovingBody& body) const {
  body.cov_birth_frame = transported(body.T_world_obj.inverse(), body.cov_T_world_obj);
  body.cov_steps.setZero();
  if (seconds(world.time - body.last_seen) > config_.recover_after_s) body.recoveries_left = kRecoveries;
}

// As more of the body shows, the frame of its birth is looked for by the points that it had before it went out of
// sight. Found better than it is known, it is the body's frame from here on; its motion is not touched by that.
void Registry::recover_birth_frame(const StereoRig& rig, PointPairs pairs, std::span<const Track* const> track_of_pair,
                                   const WorldStep& world, MovingBody& body) const {
  if (body.recoveries_left == 0) return;
  --body.recoveries_left;
  const auto placing = place_by_descriptors(rig, pairs, body.members, track_of_pair, body, ModelPart::of_birth,
                                            world.seed, reidentification_);
  if (!placing || place_variance(placing->cov_obj) > place_variance(body.cov_birth_frame) ||
      turn_variance(placing->cov_obj) > kClearlyBetter * turn_variance(body.cov_birth_frame)) {
    return;
  }
  const Rigid3 T_birth_obj = placing->T_cam_obj.inverse() * body.T_cam_obj;
  body.T_cam_obj = placing->T_cam_obj;
  body.T_world_obj = orthonormalized(world.T_world_curr * body.T_cam_obj);
  body.cov_birth_frame = placing->cov_obj;
  body.twist_obj = adjoint(T_birth_obj) * body.twist_obj;
  body.extent_m.setZero();  // of other axes
  for (ModelPoint& point : body.model) {
    if (!point.of_birth) point.p_obj = T_birth_obj * point.p_obj;
  }
  body.window.change_frame(T_birth_obj);
}

}  // namespace pelorus
