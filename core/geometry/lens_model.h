#pragma once
// One camera's projection: pinhole with a lens distortion. Raw pixels (raw_px) in, unit direction vectors out, and
// back. Coefficient orders are OpenCV's: radtan (k1 k2 p1 p2 [k3]) after Brown 1971, rational
// (k1 k2 p1 p2 k3 k4 k5 k6) after Claus & Fitzgibbon 2005, equidistant (k1 k2 k3 k4) after Kannala & Brandt 2006.
// Pure, no allocation.

#include <Eigen/Core>
#include <array>

namespace pelorus {

enum class LensKind { none, radtan, rational, equidistant };

struct CameraIntrinsics {
  int width = 0;  // 0: not written in the calibration, taken from the first image
  int height = 0;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  LensKind lens = LensKind::none;
  std::array<double, 8> distortion{};  // unused entries are zero
};

class LensModel {
 public:
  // Finds the range over which the radial polynomial grows; outside it the model folds back and is not used.
  explicit LensModel(const CameraIntrinsics& camera);

  // Raw pixel of a point in the camera's frame; false behind the camera or outside the model's range. The pixel
  // may lie outside the image.
  [[nodiscard]] bool project(const Eigen::Vector3d& p_raw, Eigen::Vector2d& raw_px) const;
  // Unit vector towards a raw pixel; false where no direction projects there.
  [[nodiscard]] bool unproject(const Eigen::Vector2d& raw_px, Eigen::Vector3d& v_raw) const;

  [[nodiscard]] const CameraIntrinsics& camera() const { return camera_; }

 private:
  // Distorted radius of an undistorted one: radius on the unit plane, or angle [rad] for equidistant.
  [[nodiscard]] double distorted_radius(double s) const;
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& x) const;
  [[nodiscard]] double undistorted_radius(double s_distorted) const;

  CameraIntrinsics camera_;
  double s_limit_ = 0;  // largest usable argument of distorted_radius
};

}  // namespace pelorus
