#include "core/geometry/transform.h"

#include <Eigen/LU>
#include <cmath>

namespace pelorus {
namespace {

// Left Jacobian of SO(3); maps rho to the translation of se3_exp.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d S = skew(phi);
  if (angle < 1e-6) return Eigen::Matrix3d::Identity() + 0.5 * S + S * S / 6.0;
  const double a2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / a2 * S +
         (angle - std::sin(angle)) / (a2 * angle) * S * S;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d S;
  S << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return S;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d S = skew(phi);
  if (angle < 1e-8) return Eigen::Matrix3d::Identity() + S + 0.5 * S * S;
  return Eigen::Matrix3d::Identity() + std::sin(angle) / angle * S + (1.0 - std::cos(angle)) / (angle * angle) * S * S;
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);  // Eigen's conversion is stable near pi, the trace formula is not
  const double s = q.vec().norm();
  if (s < 1e-12) return 2.0 * q.vec() * (q.w() < 0 ? -1.0 : 1.0);
  const double angle = 2.0 * std::atan2(s, std::abs(q.w()));
  return q.vec() * ((q.w() < 0 ? -angle : angle) / s);
}

Rigid3 se3_exp(const Vector6d& xi) {
  Rigid3 T = Rigid3::Identity();
  T.linear() = so3_exp(xi.tail<3>());
  T.translation() = left_jacobian(xi.tail<3>()) * xi.head<3>();
  return T;
}

Vector6d se3_log(const Rigid3& T) {
  Vector6d xi;
  xi.tail<3>() = so3_log(T.linear());
  xi.head<3>() = left_jacobian(xi.tail<3>()).inverse() * T.translation();
  return xi;
}

Matrix6d adjoint(const Rigid3& T) {
  Matrix6d Ad = Matrix6d::Zero();
  Ad.topLeftCorner<3, 3>() = T.linear();
  Ad.bottomRightCorner<3, 3>() = T.linear();
  Ad.topRightCorner<3, 3>() = skew(T.translation()) * T.linear();
  return Ad;
}

double rotation_angle_rad(const Eigen::Matrix3d& R) { return so3_log(R).norm(); }

Rigid3 orthonormalized(const Rigid3& T) {
  Rigid3 out = T;
  out.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return out;
}

}  // namespace pelorus
