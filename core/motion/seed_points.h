#pragma once
// Seed points (paper 5.1 and 6.1 step 2): one per cell of a grid over the view, where points are dense and the
// matching error is least. Pure apart from reserved scratch; O(points + cells * points per cell^2), bounded.

#include <vector>

#include "core/model/stage_data.h"

namespace pelorus {

struct SeedPointsConfig {
  int columns = 8;
  int rows = 6;
  double density_radius_px = 40.0;  // neighbours within it count as local density
  double density_cap = 8.0;         // more neighbours than this do not make a better seed
  double error_weight = 20.0;       // of the matching error (1 - NCC) against the neighbours' count
};

class SeedPoints {
 public:
  SeedPoints(const SeedPointsConfig& config, int capacity);
  // Seeds among `candidates`, in the order of the cells. Valid until the next call.
  [[nodiscard]] std::span<const PointIndex> run(const StereoRig& rig, PointPairs pairs,
                                                std::span<const PointIndex> candidates);

 private:
  SeedPointsConfig config_;
  std::vector<PointIndex> seeds_;
  std::vector<std::vector<PointIndex>> cells_;
};

}  // namespace pelorus
