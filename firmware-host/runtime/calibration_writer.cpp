#include "firmware-host/runtime/calibration_writer.h"

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "core/geometry/rectifier.h"
#include "firmware-host/runtime/partial_file.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

std::string list(const std::vector<double>& values) {
  std::string out = "[";
  for (const double value : values) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%.17g", value);
    out += (out.size() > 1 ? ", " : "") + std::string(digits.data());
  }
  return out + "]";
}

std::vector<double> rows_of(const Eigen::MatrixXd& m) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index k = 0; k < m.cols(); ++k) out.push_back(m(i, k));
  return out;
}

Eigen::Matrix3d camera_matrix(const CameraIntrinsics& c) {
  Eigen::Matrix3d K;
  K << c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1;
  return K;
}

// As many coefficients as the model is usually written with.
std::vector<double> coefficients(const CameraIntrinsics& c) {
  std::size_t count = 4;
  if (c.lens == LensKind::radtan && c.distortion[4] != 0) count = 5;
  if (c.lens == LensKind::rational) count = 8;
  return {c.distortion.begin(), c.distortion.begin() + static_cast<std::ptrdiff_t>(count)};
}

const char* lens_name(LensKind lens, CalibrationFormat format) {
  const bool ros = format == CalibrationFormat::ros;
  switch (lens) {
    case LensKind::none:
      return ros ? "plumb_bob" : "none";
    case LensKind::radtan:
      if (format == CalibrationFormat::euroc) return "radial-tangential";
      return ros ? "plumb_bob" : "radtan";
    case LensKind::rational:
      return ros ? "rational_polynomial" : "rational";
    case LensKind::equidistant:
      return "equidistant";
  }
  return "none";
}

using TextFiles = std::vector<TextFile>;

// The folders that a format consists of. The one around them has to be there: a mistyped path must not become one.
Result<> make_folders(const TextFiles& files, const fs::path& out) {
  const fs::path named = out.has_filename() ? out : out.parent_path();  // "rig/" is "rig"
  const fs::path around = named.has_parent_path() ? named.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(around, error))
    return Error{ErrorCode::io, out.string(), "cannot be created: " + around.string() + " is no folder",
                 "make that folder, or check the path"};
  for (const TextFile& file : files) {
    fs::create_directories(fs::absolute(file.path).parent_path(), error);
    if (error) return Error{ErrorCode::io, out.string(), "cannot create: " + error.message(), "check path and rights"};
  }
  return Ok{};
}

Result<TextFiles> opencv_files(const StereoCalibration& c, const fs::path& out) {
  const auto matrix = [](const std::string& name, int rows, int cols, const std::vector<double>& values) {
    return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(cols) +
           "\n   dt: d\n   data: " + list(values) + "\n";
  };
  // OpenCV reads any number of coefficients; both cameras get the longer list.
  if ((c.left.lens == LensKind::equidistant) != (c.right.lens == LensKind::equidistant))
    return Error{ErrorCode::unsupported, out.string(), "OpenCV's file has one lens model for both cameras",
                 "convert to euroc or kalibr"};
  const bool rational = c.left.lens == LensKind::rational || c.right.lens == LensKind::rational;
  const LensKind lens = rational ? LensKind::rational : c.left.lens == LensKind::none ? c.right.lens : c.left.lens;
  std::string text = "%YAML:1.0\n---\n";
  if (c.left.width > 0) text += "imageSize: " + list(rows_of(Eigen::RowVector2d(c.left.width, c.left.height))) + "\n";
  text += "distortion_model: " + std::string(lens_name(lens, CalibrationFormat::opencv)) + "\n";
  for (int side = 0; side < 2; ++side) {
    const CameraIntrinsics& camera = side == 0 ? c.left : c.right;
    const std::string number = std::to_string(side + 1);
    CameraIntrinsics named = camera;
    named.lens = lens;
    const std::vector<double> k = coefficients(named);
    text += matrix("M" + number, 3, 3, rows_of(camera_matrix(camera)));
    text += matrix("D" + number, 1, static_cast<int>(k.size()), k);
  }
  text += matrix("R", 3, 3, rows_of(c.T_right_left.linear()));
  text += matrix("T", 3, 1, rows_of(c.T_right_left.translation()));
  return TextFiles{{out, text}};
}

std::string rows_text(const Rigid3& T, const std::string& indent) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += indent + "- " + list(rows_of(T.matrix().row(i))) + "\n";
  return text;
}

Result<TextFiles> kalibr_files(const StereoCalibration& c, const fs::path& out) {
  std::string text;
  for (int side = 0; side < 2; ++side) {
    const CameraIntrinsics& camera = side == 0 ? c.left : c.right;
    if (camera.lens == LensKind::rational || (camera.lens == LensKind::radtan && camera.distortion[4] != 0))
      return Error{ErrorCode::unsupported, out.string(), "Kalibr's radtan has four coefficients, this lens needs more",
                   "convert to opencv or ros"};
    const Rigid3 T_camera_body = (side == 0 ? Rigid3::Identity() : c.T_right_left) * c.T_body_left.inverse();
    text += "cam" + std::to_string(side) + ":\n  camera_model: pinhole\n";
    text += "  intrinsics: " + list({camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) + "\n";
    text += "  distortion_model: " + std::string(lens_name(camera.lens, CalibrationFormat::kalibr)) + "\n";
    text += "  distortion_coeffs: " + list(coefficients(camera)) + "\n";
    text += "  resolution: [" + std::to_string(camera.width) + ", " + std::to_string(camera.height) + "]\n";
    if (c.body_known) text += "  T_cam_imu:\n" + rows_text(T_camera_body, "  ");
    if (side == 1) text += "  T_cn_cnm1:\n" + rows_text(c.T_right_left, "  ");
  }
  return TextFiles{{out, text}};
}

Result<TextFiles> ros_files(const StereoCalibration& c, const fs::path& out) {
  const auto rectifier = Rectifier::create(c, out.string());
  if (!rectifier) return rectifier.error();
  const StereoRig& rig = rectifier.value().rig();
  TextFiles files;
  for (int side = 0; side < 2; ++side) {
    const CameraIntrinsics& camera = side == 0 ? c.left : c.right;
    const Eigen::Matrix3d& R = side == 0 ? rectifier.value().R_cam_left() : rectifier.value().R_cam_r_right();
    Eigen::Matrix<double, 3, 4> P;
    P << rig.f_px, 0, rig.cx_px, side == 0 ? 0 : -rig.f_px * rig.baseline_m, 0, rig.f_px, rig.cy_px, 0, 0, 0, 1, 0;
    std::vector<double> k = coefficients(camera);
    if (k.size() == 4 && camera.lens != LensKind::equidistant) k.push_back(0);  // plumb_bob has five
    const auto matrix = [](const std::string& name, int rows, int cols, const std::vector<double>& values) {
      return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(cols) +
             "\n  data: " + list(values) + "\n";
    };
    const std::string name = side == 0 ? "left" : "right";
    std::string text = "image_width: " + std::to_string(camera.width) +
                       "\nimage_height: " + std::to_string(camera.height) + "\ncamera_name: " + name + "\n";
    text += matrix("camera_matrix", 3, 3, rows_of(camera_matrix(camera)));
    text += "distortion_model: " + std::string(lens_name(camera.lens, CalibrationFormat::ros)) + "\n";
    text += matrix("distortion_coefficients", 1, static_cast<int>(k.size()), k);
    text += matrix("rectification_matrix", 3, 3, rows_of(R));
    text += matrix("projection_matrix", 3, 4, rows_of(P));
    files.push_back({out / (name + ".yaml"), text});
  }
  return files;
}

Result<TextFiles> euroc_files(const StereoCalibration& c, const fs::path& out) {
  TextFiles files;
  for (int side = 0; side < 2; ++side) {
    const CameraIntrinsics& camera = side == 0 ? c.left : c.right;
    const Rigid3 T_body_camera = side == 0 ? c.T_body_left : c.T_body_left * c.T_right_left.inverse();
    std::string text = "%YAML:1.0\nsensor_type: camera\ncomment: written by pelorus calib convert\n";
    text += "T_BS:\n  cols: 4\n  rows: 4\n  data: " + list(rows_of(T_body_camera.matrix())) + "\n";
    text += "resolution: [" + std::to_string(camera.width) + ", " + std::to_string(camera.height) + "]\n";
    text += "camera_model: pinhole\n";
    text += "intrinsics: " + list({camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) + "\n";
    text += "distortion_model: " + std::string(lens_name(camera.lens, CalibrationFormat::euroc)) + "\n";
    text += "distortion_coefficients: " + list(coefficients(camera)) + "\n";
    files.push_back({out / "mav0" / ("cam" + std::to_string(side)) / "sensor.yaml", text});
  }
  return files;
}

Result<TextFiles> files_of(const StereoCalibration& c, CalibrationFormat format, const fs::path& out) {
  switch (format) {
    case CalibrationFormat::opencv:
      return opencv_files(c, out);
    case CalibrationFormat::kalibr:
      return kalibr_files(c, out);
    case CalibrationFormat::ros:
      return ros_files(c, out);
    case CalibrationFormat::euroc:
      return euroc_files(c, out);
  }
  return TextFiles{};
}

}  // namespace

Result<> write_calibration(const StereoCalibration& c, CalibrationFormat format, const fs::path& out, bool overwrite) {
  if (c.left.width == 0 && format != CalibrationFormat::opencv)
    return Error{ErrorCode::bad_calibration, out.string(), "the image size is not known, and this format needs it",
                 "convert the folder of the recording, whose images tell it, or add imageSize to the calibration"};
  const Result<TextFiles> files = files_of(c, format, out);
  if (!files) return files.error();
  if (Result<> made = make_folders(files.value(), out); !made) return made;
  return write_together(files.value(), overwrite);
}

}  // namespace pelorus
