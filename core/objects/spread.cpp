#include "core/objects/spread.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/fixed_vector.h"
#include "core/geometry/hull.h"

namespace pelorus {

double spread_px(PointPairs pairs, std::span<const PointIndex> members) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const PointIndex i : members) mean += pairs[static_cast<std::size_t>(i)].curr.z_px.head<2>();
  mean /= static_cast<double>(members.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const PointIndex i : members) {
    const Eigen::Vector2d d = pairs[static_cast<std::size_t>(i)].curr.z_px.head<2>() - mean;
    scatter += d * d.transpose();
  }
  scatter /= static_cast<double>(members.size());
  return std::sqrt(std::max(0.0, scatter.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff()));
}

double static_inside(PointPairs pairs, std::span<const PointRole> roles, std::span<const PointIndex> members) {
  FixedVector<Eigen::Vector2d, kMaxPoints> points;
  for (const PointIndex i : members) points.push_back(pairs[static_cast<std::size_t>(i)].curr.z_px.head<2>());
  std::array<Eigen::Vector2d, 24> outline;
  const int corners = convex_outline(points, outline);
  const std::span<const Eigen::Vector2d> hull(outline.data(), static_cast<std::size_t>(corners));
  int inside = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    inside += roles[i] == PointRole::fixed && inside_outline(hull, pairs[i].curr.z_px.head<2>());
  }
  return static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(1, members.size()));
}

Eigen::Vector3d robust_centroid(std::span<Eigen::Vector3d> points) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  const auto middle = static_cast<std::ptrdiff_t>(points.size() / 2);
  for (int axis = 0; axis < 3; ++axis) {
    std::nth_element(points.begin(), points.begin() + middle, points.end(),
                     [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    centroid[axis] = points[static_cast<std::size_t>(middle)][axis];
  }
  return centroid;
}

}  // namespace pelorus
