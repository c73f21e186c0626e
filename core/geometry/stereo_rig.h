#pragma once
// The rectified stereo pair: one focal length, rows aligned, the right camera at +baseline_m along x of `cam`.
// A stereo measurement is z_px = (u_left, v, u_right), rectified pixels; p_cam in metres. Pure, no allocation.
// Method section 2; Matthies & Shafer 1987 for the error model.

#include <Eigen/Core>

namespace pelorus {

struct StereoRig {
  int width = 0;
  int height = 0;
  double f_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  double baseline_m = 0;

  // (u_left, v, u_right) of a point in front of the camera (p_cam.z > 0).
  [[nodiscard]] Eigen::Vector3d project(const Eigen::Vector3d& p_cam) const;
  // d(project)/d(p_cam), 3x3 [px/m].
  [[nodiscard]] Eigen::Matrix3d project_jacobian(const Eigen::Vector3d& p_cam) const;
  // Point of a measurement with positive disparity (u_left - u_right > 0).
  [[nodiscard]] Eigen::Vector3d triangulate(const Eigen::Vector3d& z_px) const;
  // d(triangulate)/d(z_px), 3x3 [m/px], at the triangulated point: the inverse of project_jacobian, closed form.
  [[nodiscard]] Eigen::Matrix3d triangulate_jacobian(const Eigen::Vector3d& p_cam) const;
  // Covariance of triangulate [m^2] for the pixel covariance of (u_left, v, u_right) [px^2].
  [[nodiscard]] Eigen::Matrix3d triangulate_covariance(const Eigen::Vector3d& z_px,
                                                       const Eigen::Matrix3d& cov_px2) const;
  // sigma_z = z^2 sigma_d / (f b) [m] at depth z_m for a disparity deviation [px].
  [[nodiscard]] double depth_sigma_m(double z_m, double sigma_d_px) const;
};

}  // namespace pelorus
