#pragma once
// A smooth 6-DOF path: uniform cubic B-splines through time of position and roll, pitch, yaw, with an optional sway.
// C2 everywhere; three equal control points stand still exactly; it starts at the first point and reaches the last at
// duration_s(), then goes on straight. Frame: sea (x north, y east, z down), R_sea_b = Rz(yaw) Ry(pitch) Rx(roll).
// Pure.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/transform.h"

namespace pelorus::synthetic {

struct Sway {
  double amplitude_m = 0;
  double amplitude_rad = 0;
  double period_s = 5;
};

struct PosePath {
  double step_s = 1;                     // time between control points
  std::vector<Eigen::Vector3d> p_sea;    // at least one
  std::vector<Eigen::Vector3d> rpy_rad;  // as many as p_sea, or one for all
  Sway sway;
  std::uint64_t sway_seed = 0;  // phases of the sway

  [[nodiscard]] Rigid3 T_sea_b(double t_s) const;
  [[nodiscard]] double duration_s() const;
  // A path of one point without sway never moves.
  [[nodiscard]] bool stands_still() const;
};

}  // namespace pelorus::synthetic
