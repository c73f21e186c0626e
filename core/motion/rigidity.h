#pragma once
// The rigidity criterion (paper 5.1, Figs. 3a/3b), noise-aware: a rigid body keeps the distance between two of its
// points, | |r1| - |r2| |, here judged against its own standard deviation propagated from pixel noise
// (Hirschmueller, Innocent, Garibaldi 2002) and over the longest common history, since a one-step change is weak.
// Pure, O(history).

#include "core/model/stage_data.h"

namespace pelorus {

struct RigidityEvidence {
  double change_m = 0;  // | |r1| - |r2| | of the step with the most significant change
  double sigma_m = 0;   // its standard deviation
  // Negative log-likelihood of "one rigid body" (up to a constant): small change is good, and so is a small
  // sigma; dividing by sigma alone would favour the pairs that can tell nothing.
  double cost = 0;
};

// What the lengths to a point need of it, at every frame it was measured in; made once per point and step.
struct PointHistory {
  struct Place {
    Eigen::Vector3d p_cam = Eigen::Vector3d::Zero();
    double m_per_px = 0;       // z / f
    double per_disparity = 0;  // 1 / disparity, 1/px
  };
  std::array<Place, kPastFrames + 2> places;  // [0] now, [k] k frames back
  int size = 0;
  double variance_px2 = 0;
};
[[nodiscard]] PointHistory history_of(const StereoRig& rig, const PointPair& pair);

[[nodiscard]] RigidityEvidence rigidity(const PointHistory& seed, const PointHistory& point);

}  // namespace pelorus
