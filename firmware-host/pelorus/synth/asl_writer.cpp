#include "firmware-host/pelorus/synth/asl_writer.h"

#include <Eigen/Geometry>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <system_error>
#include <thread>

namespace pelorus {
namespace {

namespace fs = std::filesystem;

Error io_error(const fs::path& path, const std::string& detail) {
  return {ErrorCode::io, path.string(), detail, "check that the place is writable and the disk is not full"};
}

std::string pose_csv(const Rigid3& T) {
  Eigen::Quaterniond q(T.linear());
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const Eigen::Vector3d p = T.translation();
  char text[200];
  std::snprintf(text, sizeof text, "%.12g,%.12g,%.12g,%.14g,%.14g,%.14g,%.14g", p.x(), p.y(), p.z(), q.w(), q.x(),
                q.y(), q.z());
  return text;
}

// All digits: both cameras' rotations have to come back equal.
std::string rows_text(const Rigid3& T) {
  std::string rows;
  for (int row = 0; row < 4; ++row) {
    const Eigen::RowVector4d r = T.matrix().row(row);
    char text[160];
    std::snprintf(text, sizeof text, "%s%.17g, %.17g, %.17g, %.17g", row == 0 ? "" : ",\n         ", r(0), r(1), r(2),
                  r(3));
    rows += text;
  }
  return rows;
}

bool write_png(const fs::path& path, const Image& image) {
  try {
    // The wrapper does not write to the pixels; cv::Mat has no read-only form.
    const cv::Mat grey(image.height(), image.width(), CV_8U, const_cast<std::uint8_t*>(image.row(0)),
                       static_cast<std::size_t>(image.stride()));
    return cv::imwrite(path.string(), grey, {cv::IMWRITE_PNG_COMPRESSION, 1});
  } catch (const cv::Exception&) {
    return false;
  }
}

std::string camera_folder(int side) { return "mav0/cam" + std::to_string(side); }

}  // namespace

bool is_synthetic_dive(const fs::path& mav0) {
  std::ifstream sensor(mav0 / "cam0/sensor.yaml");
  for (std::string line; std::getline(sensor, line);) {
    if (line.find("Pelorus synthetic dive") != std::string::npos) return true;
  }
  return false;
}

void AslWriter::RemoveFolder::operator()(const fs::path* folder) const {
  std::error_code ignored;
  fs::remove_all(*folder, ignored);
  delete folder;
}

AslWriter::AslWriter(fs::path folder, bool replace)
    : folder_(std::move(folder)), partial_(new fs::path(folder_.string() + ".partial")), replace_(replace) {}

Result<AslWriter> AslWriter::open(const fs::path& folder, bool replace, const synthetic::SyntheticSource& source) {
  std::error_code error;
  fs::path target = fs::absolute(folder, error).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();  // a trailing slash
  if (fs::exists(target, error) && !fs::is_directory(target, error))
    return Error{ErrorCode::io, target.string(), "is a file", "name a folder that does not exist yet"};
  if (fs::exists(target, error) && !fs::is_empty(target, error) && !replace)
    return Error{ErrorCode::io, target.string(), "exists and is not empty", "name another folder, or add --overwrite"};
  // A folder of recordings given by mistake must survive.
  if (replace && fs::exists(target, error) && !fs::is_empty(target, error) && !is_synthetic_dive(target / "mav0"))
    return Error{ErrorCode::io, target.string(), "holds something else than a synthetic dive; it is not replaced",
                 "give another folder, or remove it yourself"};
  AslWriter writer(target, replace);
  fs::remove_all(*writer.partial_, error);  // left by a run that was broken off
  Result<> started = writer.write_headers(source);
  if (!started) return started.error();
  return writer;
}

Result<> AslWriter::write_headers(const synthetic::SyntheticSource& source) {
  std::error_code error;
  const auto open_csv = [&](const std::string& name, const char* header, std::ofstream& file) {
    fs::create_directories(*partial_ / name, error);
    file.open(*partial_ / name / "data.csv");
    file << header << '\n';
    return !error && file.good();
  };
  for (int side = 0; side < 2; ++side) {
    fs::create_directories(*partial_ / camera_folder(side) / "data", error);
    if (error) return io_error(*partial_, "cannot be created: " + error.message());
    if (!open_csv(camera_folder(side), "#timestamp [ns],filename", lists_[side]))
      return io_error(*partial_ / camera_folder(side) / "data.csv", "cannot be written");
    Result<> written = write_camera(side, source.calibration(), source.scene().camera.rate_hz);
    if (!written) return written;
  }
  if (!open_csv("mav0/state_groundtruth_estimate0",
                "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []",
                vehicle_truth_))
    return io_error(*partial_, "the truth cannot be written");
  object_truth_.resize(static_cast<std::size_t>(source.object_count()));
  for (std::size_t k = 0; k < object_truth_.size(); ++k) {
    if (!open_csv("mav0/object" + std::to_string(k + 1), "#timestamp_ns, p_x, p_y, p_z, q_w, q_x, q_y, q_z, visible_px",
                  object_truth_[k]))
      return io_error(*partial_, "the truth cannot be written");
    const synthetic::Body& body = source.object_body(static_cast<int>(k));
    std::ofstream box(*partial_ / ("mav0/object" + std::to_string(k + 1)) / "body.csv");
    box << "#name, size_x [m], size_y [m], size_z [m]\n"
        << body.name << ',' << body.size_m.x() << ',' << body.size_m.y() << ',' << body.size_m.z() << '\n';
    if (!box.flush()) return io_error(*partial_, "the size of a body cannot be written");
  }
  return write_goals(source.scene().goals);
}

Result<> AslWriter::write_goals(const synthetic::Goals& goals) {
  const std::string text = synthetic::goals_yaml(goals);
  if (text.empty()) return Ok{};
  const fs::path path = *partial_ / "mav0/goals.yaml";
  std::ofstream file(path);
  file << "# What `pelorus eval` holds errors on this dive to, from its scene.\n" << text;
  file.close();
  if (!file) return io_error(path, "cannot be written");
  return Ok{};
}

Result<> AslWriter::write_camera(int side, const StereoCalibration& calibration, double rate_hz) {
  const CameraIntrinsics& k = calibration.left;
  const Rigid3 T_body_side =
      side == 0 ? calibration.T_body_left : calibration.T_body_left * calibration.T_right_left.inverse();
  char text[1200];
  std::snprintf(text, sizeof text,
                "%%YAML:1.0\n"
                "# General sensor definitions.\n"
                "sensor_type: camera\n"
                "comment: Pelorus synthetic dive, cam%d of a rectified pair without distortion\n\n"
                "# Sensor extrinsics wrt. the body-frame (x forward, y starboard, z down).\n"
                "T_BS:\n  cols: 4\n  rows: 4\n  data: [%s]\n\n"
                "# Camera specific definitions.\n"
                "rate_hz: %.12g\n"
                "resolution: [%d, %d]\n"
                "camera_model: pinhole\n"
                "intrinsics: [%.12g, %.12g, %.12g, %.12g] #fu, fv, cu, cv\n"
                "distortion_model: radial-tangential\n"
                "distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n",
                side, rows_text(T_body_side).c_str(), rate_hz, k.width, k.height, k.fx_px, k.fy_px, k.cx_px, k.cy_px);
  const fs::path path = *partial_ / camera_folder(side) / "sensor.yaml";
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) return io_error(path, "cannot be written");
  return Ok{};
}

Result<> AslWriter::append(int frame, const SourcePair& pair, const synthetic::SyntheticSource& source) {
  const std::string stamp = std::to_string(pair.capture_time.ns);
  const auto image_path = [&](int side) { return *partial_ / camera_folder(side) / "data" / (stamp + ".png"); };
  bool right_written = false;
  {
    // Packing takes about as long as rendering: both sides at once.
    const std::jthread right([&] { right_written = write_png(image_path(1), pair.right); });
    if (!write_png(image_path(0), pair.left)) return io_error(image_path(0), "cannot be written");
  }
  if (!right_written) return io_error(image_path(1), "cannot be written");
  for (std::ofstream& list : lists_) list << stamp << ',' << stamp << ".png\n";
  const Rigid3 T_world_body = source.T_world_cam(frame) * source.calibration().T_body_left.inverse();
  vehicle_truth_ << stamp << ',' << pose_csv(T_world_body) << '\n';
  for (std::size_t k = 0; k < object_truth_.size(); ++k) {
    const int object = static_cast<int>(k);
    object_truth_[k] << stamp << ',' << pose_csv(source.T_world_obj(object, frame)) << ',' << source.visible_px(object)
                     << '\n';
  }
  if (!lists_[0] || !lists_[1] || !vehicle_truth_) return io_error(*partial_, "the lists cannot be written");
  return Ok{};
}

Result<> AslWriter::finish() {
  std::vector<std::ofstream*> files{&lists_[0], &lists_[1], &vehicle_truth_};
  for (std::ofstream& file : object_truth_) files.push_back(&file);
  for (std::ofstream* file : files) {
    file->close();
    if (!*file) return io_error(*partial_, "the lists cannot be written");
  }
  std::error_code error;
  if (replace_) fs::remove_all(folder_, error);
  fs::remove(folder_, error);  // an empty folder of that name
  error.clear();
  fs::rename(*partial_, folder_, error);
  if (error) return io_error(folder_, "cannot take the name from " + partial_->string() + ": " + error.message());
  return Ok{};
}

}  // namespace pelorus
