#pragma once
// Net filter (paper 5.2.2): the Delaunay net of the static points' projections gives each its neighbourhood without
// a threshold; a static point with a moving point inside one of its triangles is suspect and leaves the static
// group for this step. It is re-tested after the ego motion is refined, not lost.
// Thread-bound (scratch). O(points log points).

#include <vector>

#include "core/geometry/delaunay.h"
#include "core/model/stage_data.h"

namespace pelorus {

class StaticNet {
 public:
  explicit StaticNet(int capacity);
  // Builds the net over the points whose role is fixed.
  void build(PointPairs pairs, std::span<const PointRole> roles);
  // The three static points around a pixel, or nothing outside the net.
  [[nodiscard]] bool surrounding(const Eigen::Vector2d& px, std::array<PointIndex, 3>& vertices) const;

 private:
  Delaunay delaunay_;
  std::vector<PointIndex> vertex_of_;
  std::vector<Eigen::Vector2d> projections_px_;
};

// Marks static points around moving ones as suspect; returns how many.
int net_filter(const StaticNet& net, PointPairs pairs, std::span<PointRole> roles);

}  // namespace pelorus
