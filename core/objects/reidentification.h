#pragma once
// Recognition of a body that comes back after an occlusion (method section 8): its expected place gates, SURF
// descriptors of the group's points against those of the body's model propose matches, and a robust fit
// of the matches in the images decides and yields the pose, so that the body keeps its id and its frame. Pure;
// deterministic.

#include <optional>

#include "core/frontend/track.h"
#include "core/objects/moving_body.h"

namespace pelorus {

struct ReidentificationConfig {
  double max_descriptor_distance2 = 0.25;  // of unit-length descriptors
  double ratio2 = 0.72;                    // squared ratio of nearest to second nearest
  int min_matches = 5;
  double gate_m = 0.8;  // from the expected place, plus growth_mps per second out of sight
  double growth_mps = 0.25;
  double gate_chi2 = 16.266;
  int samples = 64;
  double motion_px = 4.0;      // a body met where it is expected, moving as expected to this, is the same
  double motion_share = 0.25;  // and to this share of its apparent motion against the static scene
};

struct Placing {
  Rigid3 T_cam_obj = Rigid3::Identity();  // at the current frame
  Matrix6d cov_obj = Matrix6d::Zero();    // right perturbations: in the body's frame
  int matches = 0;
};

struct Reidentified {
  std::int32_t body = -1;
  Placing placing;  // without matches: as expected
};

enum class ModelPart : std::uint8_t { all, of_birth };

// Pose of the body by the descriptors of `members` and those of its model, or of the part of it that was measured in
// the frame of its birth. Nothing when fewer than min_matches agree on it. O(members * model + samples * matches);
// takes 200 kB of stack.
[[nodiscard]] std::optional<Placing> place_by_descriptors(const StereoRig& rig, PointPairs pairs,
                                                          std::span<const PointIndex> members,
                                                          std::span<const Track* const> track_of_pair,
                                                          const MovingBody& body, ModelPart part, std::uint64_t seed,
                                                          const ReidentificationConfig& config);

// `T_cam_obj_expected[j]`: extrapolated pose of body j in the current camera; gates the bodies whose place is known.
[[nodiscard]] Reidentified reidentify(const StereoRig& rig, PointPairs pairs, const Group& group,
                                      std::span<const Track* const> track_of_pair, std::span<const MovingBody> bodies,
                                      std::span<const Rigid3> T_cam_obj_expected, Timestamp now, std::uint64_t seed,
                                      const ReidentificationConfig& config);

// The fall-back where descriptors fail, because the body turned or shows another side: the group is where the body is
// expected and moves as it was moving. The pose is then the extrapolated one. Each body's H_curr_prev must be its
// prediction for this step; H_static carries static points.
[[nodiscard]] Reidentified recognise_motion(const StereoRig& rig, PointPairs pairs, const Group& group,
                                            std::span<const MovingBody> bodies,
                                            std::span<const Rigid3> T_cam_obj_expected, const Rigid3& H_static,
                                            Timestamp now, const ReidentificationConfig& config);

}  // namespace pelorus
