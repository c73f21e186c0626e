// Registry's dealing with groups that no body in sight explains: identity, recognition, birth. Part of Registry.

#include <algorithm>

#include "core/base/fixed_vector.h"
#include "core/motion/stereo_transfer.h"
#include "core/objects/registry.h"
#include "core/objects/spread.h"

namespace pelorus {
namespace {

const PointPair& at(PointPairs pairs, PointIndex i) { return pairs[static_cast<std::size_t>(i)]; }

}  // namespace

void Registry::adopt(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles, const Partition& groups,
                     std::span<const Track* const> track_of_pair, const WorldStep& world, const RegistrySteps& steps,
                     std::span<BodyId> owner) {
  T_cam_obj_expected_.clear();
  for (const MovingBody& body : bodies_) {
    T_cam_obj_expected_.push_back(world.T_world_curr.inverse() * body.T_world_obj *
                                  se3_exp(body.twist_obj * world.dt_s));
  }
  if (steps.merge) split_apart(rig, pairs, owner);
  if (steps.reidentification) recognise_tentative(rig, pairs, track_of_pair, world, owner);
  const std::size_t known = bodies_.size();
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
      part_group_ = group;
      std::size_t kept = 0;
      for (std::size_t m = 0; m < group.members.size(); ++m) {
        if (part_[m] == p) part_group_.members[kept++] = group.members[m];
      }
      part_group_.members.resize(kept);
      adopt_group(rig, pairs, roles, part_group_, track_of_pair, world, steps, known, owner);
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
  if (bodies_.size() < kMaxObjects) {
    give_birth(rig, pairs, group, world, owner);
  } else {
    make_room();
  }
}

// The table is full: of the tentative bodies that are not seen, or had twice what confirmation takes, the least
// believed ends, so that its place is free in the next step.
void Registry::make_room() {
  ++births_refused_;
  MovingBody* least = nullptr;
  for (MovingBody& body : bodies_) {
    const bool had_its_chance = !body.measured || supported(body, 2);
    if (body.phase != ObjectPhase::tentative || !had_its_chance) continue;
    if (least == nullptr || body.evidence < least->evidence) least = &body;
  }
  if (least == nullptr) return;
  least->phase = ObjectPhase::ended;
  least->measured = false;
}

// Paper section 4: the frame of the object is fixed at its birth b; here with axes parallel to the world's.
void Registry::give_birth(const StereoRig& rig, PointPairs pairs, const Group& group, const WorldStep& world,
                          std::span<BodyId> owner) {
  MovingBody body = std::move(spare_.back());
  spare_.pop_back();
  body.forget();
  body.id = BodyId{next_id_++};
  body.first_seen = world.time;
  body.members = group.members;
  body.H_curr_prev = group.H_curr_prev;
  body.measured = true;
  FixedVector<Eigen::Vector3d, kMaxPoints> p_world;
  for (const PointIndex i : group.members) {
    p_world.push_back(world.T_world_prev * at(pairs, i).prev.p_cam);
    owner[static_cast<std::size_t>(i)] = body.id;
  }
  body.T_world_obj = Rigid3::Identity();
  body.T_world_obj.translation() = robust_centroid(p_world);
  body.birth_centroid_world = body.T_world_obj.translation();
  body.birth_camera_world = world.T_world_prev.translation();
  body.T_cam_obj = world.T_world_prev.inverse() * body.T_world_obj;
  add_previous_frame(rig, pairs, world, body);
  bodies_.push_back(std::move(body));
}

}  // namespace pelorus
