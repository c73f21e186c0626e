#include "core/motion/static_group.h"

#include <algorithm>
#include <cmath>

#include "core/motion/stereo_transfer.h"

namespace pelorus {
namespace {

// What the weak criteria look at, for one group or for the whole scene.
struct Extent {
  Eigen::AlignedBox2d box_px;
  Eigen::AlignedBox3d box_m;
  double range_sum_m = 0;
  int points = 0;
  int previously_static = 0;
  int previously_moving = 0;
  std::uint64_t cells = 0;

  void add(const PointPair& pair, const StereoRig& rig, const StaticGroupConfig& config) {
    box_px.extend(pair.curr.z_px.head<2>());
    box_m.extend(pair.curr.p_cam);
    range_sum_m += pair.curr.p_cam.norm();
    previously_static += pair.previous_body == kWorldBody;
    previously_moving += pair.previous_body > kWorldBody;
    ++points;
    const int column = std::clamp(static_cast<int>(pair.curr.z_px.x() * config.spread_columns / rig.width), 0,
                                  config.spread_columns - 1);
    const int row =
        std::clamp(static_cast<int>(pair.curr.z_px.y() * config.spread_rows / rig.height), 0, config.spread_rows - 1);
    cells |= std::uint64_t{1} << ((row * config.spread_columns + column) % 64);
  }
};

double ratio(double part, double whole) { return whole > 0 ? part / whole : 0.0; }

// Share of the group's points that the predicted ego motion explains nearly as well as noise allows. The gate is
// wide: the prediction is a constant velocity, not a measurement.
double prediction_agreement(const StereoRig& rig, PointPairs pairs, const Group& group, const Rigid3& H_predicted) {
  constexpr double kPredictionGate_px = 8.0;
  int agreeing = 0;
  for (const PointIndex i : group.members) {
    const PointPair& pair = pairs[static_cast<std::size_t>(i)];
    const Eigen::Vector3d p_curr = H_predicted * pair.prev.p_cam;
    agreeing += p_curr.z() > 0 && (rig.project(p_curr) - pair.curr.z_px).norm() < kPredictionGate_px;
  }
  return ratio(agreeing, static_cast<double>(group.members.size()));
}

}  // namespace

StaticChoice choose_static_group(const StereoRig& rig, PointPairs pairs, const Partition& partition,
                                 const std::optional<Rigid3>& H_predicted, const StaticGroupConfig& config,
                                 bool by_criteria) {
  Extent scene;
  for (const PointPair& pair : pairs) scene.add(pair, rig, config);
  const int scene_cells = __builtin_popcountll(scene.cells);
  StaticChoice choice;
  double best = -1;
  double second = 0;
  for (std::size_t g = 0; g < partition.groups.size(); ++g) {
    const Group& group = partition.groups[g];
    Extent extent;
    for (const PointIndex i : group.members) extent.add(pairs[static_cast<std::size_t>(i)], rig, config);
    if (extent.points == 0) continue;
    double score = ratio(extent.points, scene.points);
    if (by_criteria) {
      const double mean_range = extent.range_sum_m / extent.points;
      const double scene_range = scene.range_sum_m / scene.points;
      score = config.weight_points * score +
              config.weight_box_2d * ratio(extent.box_px.diagonal().norm(), scene.box_px.diagonal().norm()) +
              config.weight_box_3d * ratio(extent.box_m.diagonal().norm(), scene.box_m.diagonal().norm()) +
              config.weight_range * ratio(mean_range, mean_range + scene_range) +
              config.weight_spread * ratio(__builtin_popcountll(extent.cells), scene_cells) +
              config.weight_history * ratio(extent.previously_static - extent.previously_moving, extent.points);
      if (H_predicted) score += config.weight_prediction * prediction_agreement(rig, pairs, group, *H_predicted);
    }
    if (score > best) {
      second = std::max(best, 0.0);
      best = score;
      choice.group = static_cast<std::int32_t>(g);
    } else {
      second = std::max(second, score);
    }
  }
  if (choice.group >= 0) choice.world_confidence = std::clamp((best - second) / best, 0.0, 1.0);
  return choice;
}

}  // namespace pelorus
