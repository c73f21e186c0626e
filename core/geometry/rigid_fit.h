#pragma once
// Closed-form rigid alignment of matched 3D points: the initial guess of every motion (paper's "ICP" step on
// matched clouds; Horn 1987, Umeyama 1991). Pure, no allocation, O(n).

#include <optional>
#include <span>

#include "core/geometry/transform.h"

namespace pelorus {

struct PointMatch {
  Eigen::Vector3d p_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_b = Eigen::Vector3d::Zero();
  double weight = 1.0;
};

// Least-squares T_b_a (p_b = T_b_a * p_a). Empty when fewer than 3 points or all on a line: the rotation about
// the line would be arbitrary.
[[nodiscard]] std::optional<Rigid3> fit_rigid(std::span<const PointMatch> matches);

}  // namespace pelorus
