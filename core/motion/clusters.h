#pragma once
// Parts of a group that stand apart in space: two fish abreast move alike and are two. Pure. O(members^2), bounded.

#include "core/model/stage_data.h"

namespace pelorus {

struct ClustersConfig {
  double min_gap_m = 0.15;    // parts nearer to each other than this are one
  double gap_spacings = 4.0;  // and so are parts nearer than this many typical spacings of the group's points
  double gap_sigmas = 4.0;    // and nearer than this many deviations of their depth
};

// Numbers each member with its part, 0 = the largest; returns the number of parts. part has members.size() entries.
int separate_parts(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> members,
                   const ClustersConfig& config, std::span<std::int32_t> part);

}  // namespace pelorus
