#pragma once
// Which group is the world (paper 5.2): weak criteria, none decisive, each with a weight: share of points, box
// diagonal in the image and in space, range; and ours: agreement with the predicted ego motion, share of points
// that were static before, spread over the view. Pure. O(points).

#include <optional>

#include "core/model/stage_data.h"

namespace pelorus {

struct StaticGroupConfig {
  double weight_points = 1.0;      // share of all points
  double weight_box_2d = 0.5;      // diagonal of its image box over that of the scene
  double weight_box_3d = 0.5;      // the same in space
  double weight_range = 0.5;       // the seabed is farther than bodies in the water
  double weight_spread = 1.0;      // share of occupied cells of the view
  double weight_prediction = 1.0;  // agreement with the predicted ego motion
  double weight_history = 3.0;     // share of the points that were static before
  int spread_columns = 8;
  int spread_rows = 6;
};

struct StaticChoice {
  std::int32_t group = -1;      // index into the partition, -1 when it has no group
  double world_confidence = 0;  // margin of the best score over the second best, relative to the best, 0..1
};

// `H_predicted`: the ego motion expected for this step (constant velocity or a navigation prior), if any.
// `by_criteria` off: the largest group is the world (ablation).
[[nodiscard]] StaticChoice choose_static_group(const StereoRig& rig, PointPairs pairs, const Partition& partition,
                                               const std::optional<Rigid3>& H_predicted,
                                               const StaticGroupConfig& config, bool by_criteria);

}  // namespace pelorus
