#pragma once
// Members of a known body in this step (paper 5.2.4): points that were its members, and moving points inside the
// spatial hull of its points at the previous position, gated by the residual to the body's motion. The motion is
// the prediction or a fresh proposal, whichever explains more of the former members, refined by two-frame adjustment.
// Thread-bound (scratch). O(points * hull points) for the hull, bounded by the caps.

#include "core/motion/motion_proposal.h"
#include "core/motion/two_frame_ba.h"
#include "core/objects/moving_body.h"

namespace pelorus {

struct MembershipConfig {
  MotionProposalConfig proposal{.samples = 24, .gate_chi2 = 16.266, .scored_points = 60};
  double gate_chi2 = 16.266;        // 99.9 % of 3 degrees of freedom
  double hull_margin_share = 0.15;  // of the body's extent: the hull of few points is smaller than the body
  int hull_missed_frames = 15;      // the hull is where the body was expected for so many frames without a point of it
  int min_points = 4;
};

class Membership {
 public:
  Membership(const MembershipConfig& config, const TwoFrameBaConfig& ba, int capacity);

  // Fills body.members and body.H_curr_prev (measured); returns the outcome. `owner[i]` is the body that claims pair
  // i so far in this step; members found are claimed. `by_hull` off: only former members are tried (ablation).
  StageOutcome run(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles,
                   std::span<const double> chi2_static, bool by_hull, std::uint64_t seed, MovingBody& body,
                   std::span<BodyId> owner);

 private:
  void collect_candidates(const StereoRig& rig, PointPairs pairs, std::span<const PointRole> roles, bool by_hull,
                          const MovingBody& body, std::span<const BodyId> owner);

  MembershipConfig config_;
  TwoFrameBa two_frame_ba_;
  TransferPoints proposal_points_;
  std::vector<PointIndex> candidates_;  // former members first
  std::size_t former_ = 0;
  std::vector<Eigen::Vector3d> hull_points_;
};

}  // namespace pelorus
