#pragma once
// Division of all points into static and moving by the static motion (paper 5.2.1): residual of each point under
// H_static, judged against its covariance instead of a distance, with hysteresis over frames, and over the longest
// history, which finds slow bodies that one step cannot. Pure. O(points).

#include <vector>

#include "core/model/stage_data.h"

namespace pelorus {

struct RepartitionConfig {
  double stay_chi2 = 22.0;    // a point that was static stays static below this (99.99 % of 3 dof)
  double join_chi2 = 16.27;   // a new point is static below this (99.9 %)
  double return_chi2 = 7.81;  // a point of a moving body is static again only below this (95 %)
};

// T_curr_past[j] carries static points from j + 1 frames back to the current camera; [0] is H_static.
struct StaticMotions {
  std::array<Rigid3, kPastFrames + 1> T_curr_past;
  int size = 0;
};

// Sets roles[i] to fixed or moving for every pair, and chi2_static[i] to the larger of its one-step and its
// longest-history residual (3 degrees of freedom).
void repartition(const StereoRig& rig, PointPairs pairs, const StaticMotions& motions, const RepartitionConfig& config,
                 std::span<PointRole> roles, std::span<double> chi2_static);

// The larger of the residuals over one step and over the longest history known.
[[nodiscard]] double static_chi2(const StereoRig& rig, const PointPair& pair, const StaticMotions& motions);

}  // namespace pelorus
