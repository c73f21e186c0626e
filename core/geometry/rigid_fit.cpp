#include "core/geometry/rigid_fit.h"

#include <Eigen/SVD>

namespace pelorus {
namespace {
// Second singular value of the cross-covariance below this share of the first: the points lie on a line.
constexpr double kCollinearRatio = 1e-6;
}  // namespace

std::optional<Rigid3> fit_rigid(std::span<const PointMatch> matches) {
  if (matches.size() < 3) return std::nullopt;
  double weight_sum = 0;
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_b = Eigen::Vector3d::Zero();
  for (const PointMatch& m : matches) {
    weight_sum += m.weight;
    mean_a += m.weight * m.p_a;
    mean_b += m.weight * m.p_b;
  }
  if (!(weight_sum > 0)) return std::nullopt;
  mean_a /= weight_sum;
  mean_b /= weight_sum;
  Eigen::Matrix3d S = Eigen::Matrix3d::Zero();
  for (const PointMatch& m : matches) S += m.weight * (m.p_b - mean_b) * (m.p_a - mean_a).transpose();

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(S, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > kCollinearRatio * svd.singularValues()[0])) return std::nullopt;
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs.z() = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1.0 : 1.0;  // no reflection
  Rigid3 T_b_a = Rigid3::Identity();
  T_b_a.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  T_b_a.translation() = mean_b - T_b_a.linear() * mean_a;
  return T_b_a;
}

}  // namespace pelorus
