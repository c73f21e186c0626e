// ROS camera_info files as camera_calibration writes them, one for each camera.

#include "firmware-host/runtime/calibration_formats.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

struct CameraInfo {
  CameraIntrinsics camera;
  Eigen::Matrix3d R_cam_raw = Eigen::Matrix3d::Identity();  // rectification_matrix
  double shift_m = 0;                                       // fourth column of P over its focal length
  std::string projection_place;
};

Result<CameraInfo> read_camera_info(const fs::path& file) {
  const auto loaded = read_calibration_yaml(file);
  if (!loaded) return loaded.error();
  const CalibrationYaml& yaml = loaded.value();
  const auto width = numbers(yaml, yaml.root, "image_width", 1, 1);
  if (!width) return width.error();
  const auto height = numbers(yaml, yaml.root, "image_height", 1, 1);
  if (!height) return height.error();
  const auto K = numbers(yaml, yaml.root, "camera_matrix", 9, 9);
  if (!K) return K.error();
  const auto model = text(yaml, yaml.root, "distortion_model");
  if (!model) return model.error();
  const auto distortion = numbers(yaml, yaml.root, "distortion_coefficients", 0, 14);
  if (!distortion) return distortion.error();
  const auto R = numbers(yaml, yaml.root, "rectification_matrix", 9, 9);
  if (!R) return R.error();
  const auto P = numbers(yaml, yaml.root, "projection_matrix", 12, 12);
  if (!P) return P.error();

  CameraInfo out;
  out.projection_place = yaml.place(child(yaml.root, "projection_matrix"));
  out.camera.width = static_cast<int>(width.value()[0]);
  out.camera.height = static_cast<int>(height.value()[0]);
  out.camera.fx_px = K.value()[0];
  out.camera.fy_px = K.value()[4];
  out.camera.cx_px = K.value()[2];
  out.camera.cy_px = K.value()[5];
  const std::string model_place = yaml.place(child(yaml.root, "distortion_model"));
  if (auto lens = set_lens(out.camera, model.value(), distortion.value(), model_place); !lens) return lens.error();
  const std::vector<double>& r = R.value();
  const auto rotation = rigid_from_rows({r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0, 0, 0, 0, 1},
                                        yaml.place(child(yaml.root, "rectification_matrix")));
  if (!rotation) return rotation.error();
  out.R_cam_raw = rotation.value().linear();
  if (!(P.value()[0] > 0))
    return Error{ErrorCode::bad_calibration, out.projection_place, "projection matrix without focal length",
                 "calibrate the pair with camera_calibration's stereo mode"};
  out.shift_m = P.value()[3] / P.value()[0];
  return out;
}

}  // namespace

Result<LoadedCalibration> read_ros_pair(const fs::path& left_file, const fs::path& right_file) {
  const auto left = read_camera_info(left_file);
  if (!left) return left.error();
  const auto right = read_camera_info(right_file);
  if (!right) return right.error();
  LoadedCalibration out;
  out.origin = "ROS camera_info " + left_file.string() + ", " + right_file.string();
  out.assumptions = {"images are raw (camera_matrix and distortion apply to them)",
                     "extrinsics from both rectification matrices and the projection matrix of the right camera"};
  StereoCalibration& c = out.calibration;
  c.left = left.value().camera;
  c.right = right.value().camera;
  // In rectified coordinates: p_cam_r = p_cam + (shift, 0, 0); back to the raw cameras on both sides.
  const Eigen::Matrix3d R_right_cam_r = right.value().R_cam_raw.transpose();
  c.T_right_left.linear() = R_right_cam_r * left.value().R_cam_raw;
  c.T_right_left.translation() = R_right_cam_r * Eigen::Vector3d(right.value().shift_m - left.value().shift_m, 0, 0);
  if (auto checked = check_calibration(c, right.value().projection_place); !checked) return checked.error();
  return out;
}

}  // namespace pelorus
