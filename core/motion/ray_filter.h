#pragma once
// Ray filter (paper 5.2.3): the ray through a moving point is cut with the static surface (the Delaunay net, in
// space); a moving point nearer to the surface than the propagated error is false. Deviation: unless its motion
// evidence over several frames is itself conclusive, since a body that slides on the seabed is real.
// Pure. O(points).

#include "core/motion/net_filter.h"

namespace pelorus {

struct RayFilterConfig {
  double gate_sigmas = 3.0;       // nearer to the surface than this: adjoining
  double conclusive_chi2 = 50.0;  // static residual over the history above which the motion speaks for itself
  int conclusive_history = 3;     // frames of history needed for it
};

// Turns moving points that adjoin the static surface into outliers; returns how many. Points of a known body stay.
int ray_filter(const StereoRig& rig, const StaticNet& net, PointPairs pairs, std::span<const double> chi2_static,
               const RayFilterConfig& config, std::span<PointRole> roles);

}  // namespace pelorus
