#pragma once
// Rigid motions. T_a_b maps coordinates in b to coordinates in a: p_a = T_a_b * p_b. Pure, no allocation.
// A twist is (rho, phi): translation part first [m], rotation vector second [rad]. Perturbations are on the
// left: T = exp(xi) * T_hat; covariances of transforms are of that xi (6x6, m^2 and rad^2).

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pelorus {

using Rigid3 = Eigen::Isometry3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);
[[nodiscard]] Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi);
[[nodiscard]] Eigen::Vector3d so3_log(const Eigen::Matrix3d& R);
[[nodiscard]] Rigid3 se3_exp(const Vector6d& xi);
[[nodiscard]] Vector6d se3_log(const Rigid3& T);
// Adjoint for the twist order above: T exp(xi) T^-1 = exp(Ad(T) xi).
[[nodiscard]] Matrix6d adjoint(const Rigid3& T);
// Covariance of a perturbation in the axes of a, given the one in those of b: Ad(T_a_b) cov_b Ad(T_a_b)^T.
[[nodiscard]] inline Matrix6d transported(const Rigid3& T_a_b, const Matrix6d& cov_b) {
  const Matrix6d Ad = adjoint(T_a_b);
  return Ad * cov_b * Ad.transpose();
}
// Rotation angle [rad], 0..pi.
[[nodiscard]] double rotation_angle_rad(const Eigen::Matrix3d& R);
// Nearest rotation after a long product (called by the trajectory only).
[[nodiscard]] Rigid3 orthonormalized(const Rigid3& T);

}  // namespace pelorus
