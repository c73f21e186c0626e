#pragma once
// Coarse partition of points into rigid groups (paper 5.1, 6.1 steps 2-3; method section 4). Rigidity to seed
// points proposes groups; each proposal gets a motion; motions are kept while they explain points that no better
// one explains (which consolidates proposals that agree); points are then re-assigned to the motion with the least
// stereo residual, neighbours preferring one label, outliers said to be outliers.
// Thread-bound; deterministic; bounded by the caps: O(seeds * points + groups * motions * points).

#include "core/motion/motion_proposal.h"
#include "core/motion/rigidity.h"
#include "core/motion/seed_points.h"
#include "core/motion/transfer_points.h"
#include "core/motion/two_frame_ba.h"

namespace pelorus {

struct GroupingConfig {
  MotionProposalConfig proposal;
  double gate_chi2 = 16.266;  // 99.9 % of 3 degrees of freedom: a point further off is not explained
  int min_group_points = 6;
  int max_groups = 8;
  int reassignments = 2;
  double smoothness_chi2 = 6.0;  // what disagreement with all neighbours costs, in units of chi-square
  int neighbours = 6;
  double neighbour_radius_px = 80.0;
  double known_share = 0.8;  // of a proposed group that a known motion explains: it needs no motion of its own
};

class Grouping {
 public:
  Grouping(const GroupingConfig& config, const SeedPointsConfig& seeds, const TwoFrameBaConfig& ba, int capacity);

  struct Options {
    bool rigidity = true;      // off: proposals are drawn from all candidates (ablation)
    bool reassignment = true;  // off: points keep the motion that claimed them first (ablation)
  };

  // Groups among `candidates`, best explained first. `prior_motions` (predicted ego motion, known bodies) compete as
  // proposals on equal terms. group_of has one entry per pair (-1 outside the candidates). Valid until next call.
  [[nodiscard]] const Partition& run(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                                     std::span<const Rigid3> prior_motions, std::uint64_t seed, const Options& options);

 private:
  void propose_by_rigidity(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                           std::uint64_t seed);
  void propose_by_sampling(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                           std::uint64_t seed);
  void propose_by_labels(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                         std::uint64_t seed);
  [[nodiscard]] bool is_known(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> group,
                              std::size_t known_motions);
  void score(const StereoRig& rig, const Rigid3& motion, std::vector<float>& chi2);
  void claim_groups(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates);
  [[nodiscard]] std::size_t most_explaining();
  [[nodiscard]] bool claim(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                           std::size_t proposal);
  void reassign(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates);
  [[nodiscard]] Group empty_group();
  void find_neighbours(PointPairs pairs, std::span<const PointIndex> candidates);
  void collect_members(std::span<const PointIndex> candidates);

  GroupingConfig config_;
  SeedPoints seed_points_;
  TwoFrameBa two_frame_ba_;
  std::vector<Rigid3> motions_;  // proposals, then their chi-square per candidate
  std::vector<std::vector<float>> motion_chi2_;
  std::vector<float> refined_chi2_;
  std::vector<std::vector<PointIndex>> spare_;  // members' storage of groups of the past
  std::vector<std::vector<PointIndex>> seed_groups_;
  std::vector<PointHistory> histories_;  // per pair
  std::vector<PointIndex> labelled_;
  TransferPoints candidate_points_;
  TransferPoints proposal_points_;
  std::vector<std::int32_t> neighbours_;  // candidates.size() * config.neighbours, -1 = none
  std::vector<std::int32_t> label_;       // per candidate position
  Partition partition_;
};

}  // namespace pelorus
