#include "core/frontend/warp.h"

#include <cmath>

namespace pelorus {
namespace {

double determinant(const Warp& w) {
  return static_cast<double>(w[0]) * static_cast<double>(w[3]) - static_cast<double>(w[1]) * static_cast<double>(w[2]);
}

}  // namespace

Warp step_warp(const StereoRig& rig, const Rigid3& H_curr_prev, const Eigen::Vector3d& p_prev,
               const Eigen::Vector2d& disparity_gradient) {
  const Eigen::Vector3d p_curr = H_curr_prev * p_prev;
  if (!(p_curr.z() > 0.05) || !(p_prev.z() > 0.05)) return {1, 0, 0, 1};
  // d p_prev / d (u, v) along the surface: one pixel is z / f metres across, and the disparity changes by its gradient.
  const double m_per_px = p_prev.z() / rig.f_px;
  const Eigen::Vector3d per_disparity = -p_prev * (p_prev.z() / (rig.f_px * rig.baseline_m));
  Eigen::Matrix<double, 3, 2> along;
  along.col(0) = Eigen::Vector3d(m_per_px, 0, 0) + per_disparity * disparity_gradient.x();
  along.col(1) = Eigen::Vector3d(0, m_per_px, 0) + per_disparity * disparity_gradient.y();
  const Eigen::Matrix2d W = rig.project_jacobian(p_curr).topRows<2>() * (H_curr_prev.linear() * along);
  return {static_cast<float>(W(0, 0)), static_cast<float>(W(0, 1)), static_cast<float>(W(1, 0)),
          static_cast<float>(W(1, 1))};
}

Warp stereo_warp(const Eigen::Vector2d& disparity_gradient) {
  return {static_cast<float>(1.0 - disparity_gradient.x()), static_cast<float>(-disparity_gradient.y()), 0, 1};
}

Warp compose_warp(const Warp& later, const Warp& earlier) {
  return {later[0] * earlier[0] + later[1] * earlier[2], later[0] * earlier[1] + later[1] * earlier[3],
          later[2] * earlier[0] + later[3] * earlier[2], later[2] * earlier[1] + later[3] * earlier[3]};
}

Warp inverse_warp(const Warp& warp) {
  const double d = determinant(warp);
  if (std::abs(d) < 1e-6) return {1, 0, 0, 1};
  const auto s = static_cast<float>(1.0 / d);
  return {warp[3] * s, -warp[1] * s, -warp[2] * s, warp[0] * s};
}

bool usable_warp(const Warp& warp) {
  const double area = determinant(warp);
  double sum = 0;
  for (const float w : warp) sum += static_cast<double>(w) * static_cast<double>(w);
  // For a similarity the squared entries sum to twice the area; shear makes the sum grow.
  return area > 0.36 && area < 2.56 && sum < 2.6 * area;
}

}  // namespace pelorus
