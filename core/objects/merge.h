#pragma once
// Consolidation of bodies (paper 5.2.4, last step): two that move alike (displacement and rotation of their step
// motions, in deviations) and touch in space are one. Two fish abreast do not touch and stay two. Pure. O(1) per pair
// but for the hull distance.

#include "core/objects/moving_body.h"

namespace pelorus {

struct MergeConfig {
  double gate_chi2 = 12.6;    // 95 % of 6 degrees of freedom, over one step
  int agreeing_frames = 4;    // in a row before two confirmed bodies become one
  double touch_share = 0.15;  // gap between hulls, of the mean extent
  double min_touch_m = 0.05;
};

// Squared Mahalanobis distance between the two bodies' step motions, taken at the centroid of b.
[[nodiscard]] double motion_mismatch(const MovingBody& a, const MovingBody& b);
// Whether their points' hulls are nearer to each other than the configured gap.
[[nodiscard]] bool touching(PointPairs pairs, const MovingBody& a, const MovingBody& b, const MergeConfig& config);

}  // namespace pelorus
