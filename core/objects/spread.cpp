#include "core/objects/spread.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

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

}  // namespace pelorus
