#include "core/motion/seed_points.h"

#include <algorithm>

namespace pelorus {
namespace {

double distance2_px(const PointPair& a, const PointPair& b) {
  return (a.curr.z_px.head<2>() - b.curr.z_px.head<2>()).squaredNorm();
}

}  // namespace

SeedPoints::SeedPoints(const SeedPointsConfig& config, int capacity) : config_(config) {
  cells_.resize(static_cast<std::size_t>(config.columns * config.rows));
  for (auto& cell : cells_) cell.reserve(static_cast<std::size_t>(capacity));
  seeds_.reserve(cells_.size());
}

std::span<const PointIndex> SeedPoints::run(const StereoRig& rig, PointPairs pairs,
                                            std::span<const PointIndex> candidates) {
  for (auto& cell : cells_) cell.clear();
  for (const PointIndex i : candidates) {
    const auto& z_px = pairs[static_cast<std::size_t>(i)].curr.z_px;
    const int column = std::clamp(static_cast<int>(z_px.x() * config_.columns / rig.width), 0, config_.columns - 1);
    const int row = std::clamp(static_cast<int>(z_px.y() * config_.rows / rig.height), 0, config_.rows - 1);
    cells_[static_cast<std::size_t>(row * config_.columns + column)].push_back(i);
  }
  seeds_.clear();
  const double radius2 = config_.density_radius_px * config_.density_radius_px;
  for (const auto& cell : cells_) {
    PointIndex best = -1;
    double best_score = 0;
    for (const PointIndex i : cell) {
      const PointPair& pair = pairs[static_cast<std::size_t>(i)];
      double neighbours = 0;
      for (const PointIndex j : cell) neighbours += distance2_px(pair, pairs[static_cast<std::size_t>(j)]) < radius2;
      const double score = std::min(neighbours, config_.density_cap) - config_.error_weight * pair.match_error;
      if (best < 0 || score > best_score) {
        best = i;
        best_score = score;
      }
    }
    if (best >= 0) seeds_.push_back(best);
  }
  return seeds_;
}

}  // namespace pelorus
