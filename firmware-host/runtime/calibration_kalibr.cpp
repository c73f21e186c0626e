// Kalibr's camchain.yaml (Furgale, Rehder, Siegwart 2013): cam0, cam1, ..., each with its model and the transform
// from the camera before it.

#include "firmware-host/runtime/calibration_formats.h"

namespace pelorus {
namespace {

Error refuse(const std::string& place, std::string detail, std::string cure) {
  return Error{ErrorCode::bad_calibration, place, std::move(detail), std::move(cure)};
}

Result<> read_camera(const CalibrationYaml& yaml, const YAML::Node& node, CameraIntrinsics& camera) {
  const auto projection = text(yaml, node, "camera_model");
  if (!projection) return projection.error();
  if (projection.value() != "pinhole")
    return refuse(yaml.place(child(node, "camera_model")), "unknown camera model '" + projection.value() + "'",
                  "calibrate with pinhole and radtan, or pinhole and equi for a fisheye");
  const auto k = numbers(yaml, node, "intrinsics", 4, 4);
  if (!k) return k.error();
  const auto size = numbers(yaml, node, "resolution", 2, 2);
  if (!size) return size.error();
  const auto model = text(yaml, node, "distortion_model");
  if (!model) return model.error();
  std::vector<double> coefficients;
  if (model.value() != "none") {
    auto read = numbers(yaml, node, "distortion_coeffs", 4, 8);
    if (!read) return read.error();
    coefficients = std::move(read.value());
  }
  camera.fx_px = k.value()[0];
  camera.fy_px = k.value()[1];
  camera.cx_px = k.value()[2];
  camera.cy_px = k.value()[3];
  camera.width = static_cast<int>(size.value()[0]);
  camera.height = static_cast<int>(size.value()[1]);
  return set_lens(camera, model.value(), coefficients, yaml.place(child(node, "distortion_model")));
}

Result<Rigid3> read_transform(const CalibrationYaml& yaml, const YAML::Node& node, const std::string& key) {
  const auto rows = numbers(yaml, node, key, 16, 16);
  if (!rows) return rows.error();
  return rigid_from_rows(rows.value(), yaml.place(child(node, key)));
}

}  // namespace

Result<LoadedCalibration> read_kalibr(const CalibrationYaml& yaml) {
  LoadedCalibration out;
  out.origin = "Kalibr camchain " + yaml.file;
  out.assumptions = {"cam0 is the left camera, cam1 the right one"};
  StereoCalibration& c = out.calibration;
  const YAML::Node left = child(yaml.root, "cam0");
  const YAML::Node right = child(yaml.root, "cam1");
  if (!right.IsDefined())
    return refuse(yaml.file, "has cam0 but no cam1", "calibrate both cameras in one run of kalibr_calibrate_cameras");
  if (auto read = read_camera(yaml, left, c.left); !read) return read.error();
  if (auto read = read_camera(yaml, right, c.right); !read) return read.error();
  if (child(left, "T_cam_imu").IsDefined()) {
    const auto T_left_body = read_transform(yaml, left, "T_cam_imu");
    if (!T_left_body) return T_left_body.error();
    c.T_body_left = T_left_body.value().inverse();
    c.body_known = true;
    out.assumptions.push_back("the IMU's frame is the body frame (T_cam_imu maps IMU to camera)");
  }
  std::string extrinsics = "T_cn_cnm1";
  if (!child(right, "T_cn_cnm1").IsDefined() && c.body_known && child(right, "T_cam_imu").IsDefined()) {
    extrinsics = "T_cam_imu";
    const auto T_right_body = read_transform(yaml, right, extrinsics);
    if (!T_right_body) return T_right_body.error();
    c.T_right_left = T_right_body.value() * c.T_body_left;
    out.assumptions.push_back("extrinsics from both T_cam_imu, T_cn_cnm1 being absent");
  } else {
    const auto T_right_left = read_transform(yaml, right, extrinsics);
    if (!T_right_left) return T_right_left.error();
    c.T_right_left = T_right_left.value();
    out.assumptions.push_back("T_cn_cnm1 of cam1 maps cam0 coordinates to cam1");
  }
  if (auto checked = check_calibration(c, yaml.place(child(right, extrinsics))); !checked) return checked.error();
  return out;
}

}  // namespace pelorus
