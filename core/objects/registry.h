#pragma once
// The table of moving bodies with their lifetimes (paper 6.1) and their passage through a step (6.2): prediction,
// membership, identity of new groups, re-identification, refinement, birth, coasting, end. Thread-bound.
// Nothing is an object before it has points, frames and spread enough, and evidence that it moves.

#include "core/motion/clusters.h"
#include "core/objects/identity.h"
#include "core/objects/membership.h"
#include "core/objects/merge.h"
#include "core/objects/reidentification.h"

namespace pelorus {

struct RegistryConfig {
  int min_points = 6;               // of a birth
  double part_reach_share = 0.35;   // of a body's extent: a smaller group this near its hull is a part of it
  double max_static_inside = 0.6;   // static points inside its outline, per member: more, and it is no one body
  double min_spread_px = 4.0;       // deviation of its points along their second axis in the image
  int confirm_frames = 3;           // measured frames before a body is an object
  int confirm_points = 8;           // that support it in the frame of its confirmation
  int confirm_support = 450;        // and frames times points squared: few points agree by chance, and must persist
  double confirm_evidence = 150.0;  // log-likelihood ratio of own motion against static, summed
  double evidence_cap = 20.0;       // per point and frame
  double confirm_sigmas = 6.0;      // displacement since birth over its deviation
  double confirm_move_px = 2.0;     // and at least this much in the image, beyond any systematic matching error
  // And this share of the camera's own way meanwhile: what an error of calibration (or refraction) makes of points at
  // rest is in proportion to it. More, in inverse proportion, of a body seen in fewer than confirm_ego_frames.
  double confirm_ego_share = 0.05;
  int confirm_ego_frames = 12;
  double tentative_patience_frames = 2;
  double coast_s = 4.0;                  // out of sight before a confirmed body ends
  double recover_after_s = 0.5;          // out of sight; the frame of the body's birth is looked for when it is back
  double sigma_acceleration_mps2 = 0.3;  // growth of the covariance while coasting
  double sigma_acceleration_radps2 = 0.3;
  ClustersConfig clusters;
  double min_share_in_parts = 0.7;  // of a group in parts large enough to be bodies, else it is scatter ...
  double min_share_of_one = 0.5;    // ... unless the largest part alone holds this share
  int split_frames = 5;             // in a row in which a body stands apart before it is two
  int max_model_points = 250;
};

struct RegistrySteps {
  bool hull_membership = true;
  bool identity_mismatch = true;
  bool merge = true;
  bool object_window = true;
  bool reidentification = true;
  bool birth_frame = true;  // of a body that is back: recovery of the frame of its birth
};

// What the static part of the step found.
struct WorldStep {
  Timestamp time;
  double dt_s = 0.1;
  Rigid3 T_world_prev = Rigid3::Identity();  // camera at the previous frame
  Rigid3 T_world_curr = Rigid3::Identity();
  Matrix6d cov_H_static = Matrix6d::Zero();
  std::uint64_t seed = 0;
};

class Registry {
 public:
  Registry(const RegistryConfig& config, const MembershipConfig& membership, const IdentityConfig& identity,
           const MergeConfig& merge, const ReidentificationConfig& reidentification, const BodyWindowConfig& window,
           const TwoFrameBaConfig& ba, int capacity);

  // Expected apparent motion of each body for the coming step, given the expected camera pose.
  void predict(const Rigid3& T_world_prev, const Rigid3& T_world_curr, double dt_s);
  // Members of the known bodies; claims their pairs in `owner`.
  void claim(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
             std::span<const double> chi2_static, const WorldStep& world, const RegistrySteps& steps,
             std::span<BodyId> owner);
  // New groups among the moving points that no body claimed: identified, re-identified or registered.
  void adopt(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles, const Partition& groups,
             std::span<const Track* const> track_of_pair, const WorldStep& world, const RegistrySteps& steps,
             std::span<BodyId> owner);
  // Poses, windows, evidence, phases; merges and ends. Releases pairs of bodies that ended in `owner`.
  void settle(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
              std::span<const double> chi2_static, std::span<const Track* const> track_of_pair, const WorldStep& world,
              const RegistrySteps& steps, std::span<BodyId> owner);

  // The camera lost its own motion: nothing is known of this step, nor where the bodies are from now on. Confirmed ones
  // coast until their descriptors are recognised, which tells their place; the others end.
  void lose();

  [[nodiscard]] std::span<const MovingBody> bodies() const { return bodies_; }
  // Groups of the last step that were bodies by all tests, and found the table full.
  [[nodiscard]] int births_refused() const { return births_refused_; }
  // Whether `id` names a body that was confirmed once and has not ended.
  [[nodiscard]] bool is_confirmed(BodyId id) const;

 private:
  void measure(const StereoRig& rig, PointPairs pairs, std::span<const Track* const> track_of_pair,
               const WorldStep& world, const RegistrySteps& steps, MovingBody& body);
  void bridge_window(const StereoRig& rig, PointPairs pairs, const WorldStep& world, MovingBody& body);
  void add_previous_frame(const StereoRig& rig, PointPairs pairs, const WorldStep& world, MovingBody& body);
  void remember_points(PointPairs pairs, std::span<const Track* const> track_of_pair, MovingBody& body);
  void weigh_evidence(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                      std::span<const double> chi2_static, const WorldStep& world, MovingBody& body) const;
  [[nodiscard]] bool moved_significantly(const StereoRig& rig, const WorldStep& world, const MovingBody& body) const;
  [[nodiscard]] bool part_of_another(const MovingBody& body) const;
  void coast(const WorldStep& world, MovingBody& body) const;
  void adopt_group(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles, const Group& group,
                   std::span<const Track* const> track_of_pair, const WorldStep& world, const RegistrySteps& steps,
                   std::size_t known, std::span<BodyId> owner);
  void recognise_tentative(const StereoRig& rig, PointPairs pairs, std::span<const Track* const> track_of_pair,
                           const WorldStep& world, std::span<BodyId> owner);
  void split_apart(const StereoRig& rig, PointPairs pairs, std::span<BodyId> owner);
  void give_birth(const StereoRig& rig, PointPairs pairs, const Group& group, const WorldStep& world,
                  std::span<BodyId> owner);
  void resume(const StereoRig& rig, PointPairs pairs, const Group& group, const Reidentified& found,
              const WorldStep& world, std::span<BodyId> owner);
  void expect_birth_frame(const WorldStep& world, MovingBody& body) const;
  [[nodiscard]] static bool frame_is_of_birth(const MovingBody& body) { return body.cov_birth_frame.isZero(0); }
  void recover_birth_frame(const StereoRig& rig, PointPairs pairs, std::span<const Track* const> track_of_pair,
                           const WorldStep& world, MovingBody& body) const;
  void make_room();
  [[nodiscard]] bool supported(const MovingBody& body, int times) const;
  void retire_ended(std::span<BodyId> owner);
  void merge_alike(PointPairs pairs, std::span<BodyId> owner);
  void release(const MovingBody& body, std::span<BodyId> owner) const;

  RegistryConfig config_;
  Membership membership_;
  IdentityConfig identity_;
  MergeConfig merge_;
  ReidentificationConfig reidentification_;
  TwoFrameBa two_frame_ba_;
  std::vector<MovingBody> bodies_;
  std::vector<MovingBody> spare_;  // with their storage: births and ends do not touch the heap
  Group part_group_;
  std::vector<Rigid3> T_cam_obj_expected_;
  std::vector<std::int32_t> part_;
  std::vector<WindowObservation> observations_;
  std::vector<std::array<std::int32_t, 3>> alike_;  // ids of two bodies and the frames they moved alike in a row
  std::int32_t next_id_ = 1;
  std::int64_t step_ = 0;
  int births_refused_ = 0;
};

}  // namespace pelorus
