#include "core/geometry/stereo_rig.h"

namespace pelorus {

Eigen::Vector3d StereoRig::project(const Eigen::Vector3d& p_cam) const {
  const double iz = 1.0 / p_cam.z();
  const double u = f_px * p_cam.x() * iz + cx_px;
  return {u, f_px * p_cam.y() * iz + cy_px, u - f_px * baseline_m * iz};
}

Eigen::Matrix3d StereoRig::project_jacobian(const Eigen::Vector3d& p_cam) const {
  const double iz = 1.0 / p_cam.z();
  const double f_iz = f_px * iz;
  Eigen::Matrix3d J;
  J << f_iz, 0, -f_iz * p_cam.x() * iz,                //
      0, f_iz, -f_iz * p_cam.y() * iz,                 //
      f_iz, 0, -f_iz * (p_cam.x() - baseline_m) * iz;  //
  return J;
}

Eigen::Vector3d StereoRig::triangulate(const Eigen::Vector3d& z_px) const {
  const double z_m = f_px * baseline_m / (z_px.x() - z_px.z());
  return {(z_px.x() - cx_px) * z_m / f_px, (z_px.y() - cy_px) * z_m / f_px, z_m};
}

Eigen::Matrix3d StereoRig::triangulate_jacobian(const Eigen::Vector3d& p_cam) const {
  // p = (b (u - cx) / d, b (v - cy) / d, f b / d) with disparity d = u_left - u_right = f b / z.
  const double m_per_px = p_cam.z() / f_px;  // b / d
  const double disparity_px = f_px * baseline_m / p_cam.z();
  const Eigen::Vector3d per_disparity = -p_cam / disparity_px;  // dp/dd
  Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
  J.col(0) = per_disparity;
  J(0, 0) += m_per_px;
  J(1, 1) = m_per_px;
  J.col(2) = -per_disparity;
  return J;
}

Eigen::Matrix3d StereoRig::triangulate_covariance(const Eigen::Vector3d& z_px, const Eigen::Matrix3d& cov_px2) const {
  const Eigen::Matrix3d J = triangulate_jacobian(triangulate(z_px));
  return J * cov_px2 * J.transpose();
}

double StereoRig::depth_sigma_m(double z_m, double sigma_d_px) const {
  return z_m * z_m * sigma_d_px / (f_px * baseline_m);
}

}  // namespace pelorus
