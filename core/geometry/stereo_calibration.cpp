#include "core/geometry/stereo_calibration.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdio>

namespace pelorus {
namespace {

constexpr double kMinBaseline_m = 1e-4;
constexpr double kMaxBaseline_m = 20;        // beyond it the translation is in millimetres, not metres
constexpr double kMaxFocalOverWidth = 20;    // 3 deg of view
constexpr double kMinFocalOverWidth = 0.05;  // wider than any fisheye
constexpr int kMaxSide = 32767;              // remap tables hold 16-bit positions

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

Error refuse(const std::string& place, std::string detail, std::string cure) {
  return Error{ErrorCode::bad_calibration, place, std::move(detail), std::move(cure)};
}

Result<> check_camera(const CameraIntrinsics& camera, const std::string& side, const std::string& place) {
  if (camera.width < 0 || camera.height < 0 || camera.width > kMaxSide || camera.height > kMaxSide)
    return refuse(place,
                  side + " camera: image size " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                      " is impossible",
                  "correct the image size");
  for (const double f_px : {camera.fx_px, camera.fy_px}) {
    // Without a size the bound is that of an image of 1000 px.
    const double width = camera.width > 0 ? camera.width : 1000;
    if (!(f_px > kMinFocalOverWidth * width && f_px < kMaxFocalOverWidth * width))
      return refuse(place, side + " camera: focal length " + number(f_px) + " px is absurd",
                    "focal lengths are in pixels; check the order fx, fy, cx, cy");
  }
  if (camera.fx_px > 2 * camera.fy_px || camera.fy_px > 2 * camera.fx_px)
    return refuse(
        place,
        side + " camera: focal lengths " + number(camera.fx_px) + " and " + number(camera.fy_px) + " px disagree",
        "check the order fx, fy, cx, cy");
  const bool inside = camera.width == 0 || (camera.cx_px > -0.5 * camera.width && camera.cx_px < 1.5 * camera.width &&
                                            camera.cy_px > -0.5 * camera.height && camera.cy_px < 1.5 * camera.height);
  if (!inside || !std::isfinite(camera.cx_px) || !std::isfinite(camera.cy_px))
    return refuse(place,
                  side + " camera: principal point (" + number(camera.cx_px) + ", " + number(camera.cy_px) +
                      ") px is far outside the image",
                  "check the order fx, fy, cx, cy and the image size");
  for (const double k : camera.distortion)
    if (!std::isfinite(k)) return refuse(place, side + " camera: a distortion coefficient is not a number", "");
  return Ok{};
}

Result<> check_extrinsics(const Rigid3& T_right_left, const std::string& place) {
  const Eigen::Matrix3d R = T_right_left.linear();
  if (!R.allFinite() || !T_right_left.translation().allFinite() ||
      (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-3 || R.determinant() < 0)
    return refuse(place, "the rotation between the cameras is not a rotation matrix", "check its nine numbers");
  // Where the right camera stands, in the left camera's axes.
  const Eigen::Vector3d c = -(R.transpose() * T_right_left.translation());
  if (c.norm() < kMinBaseline_m)
    return refuse(place, "no baseline: the cameras are " + number(c.norm()) + " m apart",
                  "calibrate the two cameras together, or give the extrinsics in metres");
  if (c.norm() > kMaxBaseline_m)
    return refuse(place, "the baseline of " + number(c.norm()) + " m is absurd", "extrinsics must be in metres");
  if (std::abs(c.y()) > std::abs(c.x()) || std::abs(c.z()) > std::abs(c.x()))
    return refuse(place,
                  "the right camera stands at (" + number(c.x()) + ", " + number(c.y()) + ", " + number(c.z()) +
                      ") m from the left one, not beside it",
                  "only horizontal pairs are supported; check the direction of the extrinsics");
  if (c.x() < 0)
    return refuse(place,
                  "negative baseline: the right camera stands " + number(-c.x()) + " m to the left of the left one",
                  "the cameras are swapped, or the extrinsics are given in the other direction: exchange them");
  return Ok{};
}

}  // namespace

Result<> check_calibration(const StereoCalibration& calibration, const std::string& place) {
  if (auto left = check_camera(calibration.left, "left", place); !left) return left;
  if (auto right = check_camera(calibration.right, "right", place); !right) return right;
  if (calibration.left.width != calibration.right.width || calibration.left.height != calibration.right.height)
    return refuse(place,
                  "the cameras' image sizes differ: " + std::to_string(calibration.left.width) + "x" +
                      std::to_string(calibration.left.height) + " and " + std::to_string(calibration.right.width) +
                      "x" + std::to_string(calibration.right.height),
                  "record and calibrate both cameras at one resolution");
  return check_extrinsics(calibration.T_right_left, place);
}

}  // namespace pelorus
