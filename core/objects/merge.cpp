#include "core/objects/merge.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/base/fixed_vector.h"
#include "core/geometry/hull.h"

namespace pelorus {
namespace {

// Left perturbation about the world origin, moved to one about the point c: translation there, rotation unchanged.
Matrix6d at_point(const Eigen::Vector3d& c) {
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -skew(c);
  return J;
}

}  // namespace

double motion_mismatch(const MovingBody& a, const MovingBody& b) {
  const Matrix6d J = at_point(b.T_world_obj * b.centroid_obj);
  const Vector6d difference = J * se3_log(a.M_world * b.M_world.inverse());
  Matrix6d cov = J * (a.cov_M_world + b.cov_M_world) * J.transpose();
  // Neighbouring points of one body share systematic errors that the covariances do not know.
  cov.topLeftCorner<3, 3>().diagonal().array() += 1e-6;
  cov.bottomRightCorner<3, 3>().diagonal().array() += 1e-6;
  return difference.dot(cov.ldlt().solve(difference));
}

bool touching(PointPairs pairs, const MovingBody& a, const MovingBody& b, const MergeConfig& config) {
  if (a.members.empty() || b.members.empty()) return false;
  FixedVector<Eigen::Vector3d, kMaxPoints> hull;
  for (const PointIndex i : a.members) hull.push_back(pairs[static_cast<std::size_t>(i)].curr.p_cam);
  const double gap_m = std::max(config.min_touch_m, config.touch_share * 0.5 * (a.extent_m.norm() + b.extent_m.norm()));
  return std::any_of(b.members.begin(), b.members.end(), [&](PointIndex i) {
    return distance_to_hull(hull, pairs[static_cast<std::size_t>(i)].curr.p_cam) < gap_m;
  });
}

}  // namespace pelorus
