#include "firmware-host/pelorus/results/result_files.h"

#include <cerrno>
#include <cinttypes>
#include <cmath>
#include <cstring>
#include <regex>
#include <system_error>

namespace pelorus {
namespace {

namespace fs = std::filesystem;

// 12 significant digits: below a nanometre at kilometres, and the same text for the same double everywhere.
constexpr const char* kNumber = ",%.12g";

void put(std::FILE* file, double number) { std::fprintf(file, kNumber, number); }

void put_rigid(std::FILE* file, const Rigid3& T) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(T.linear()).normalized();
  // One of the two signs of a quaternion, always the same: w >= 0.
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  for (int i = 0; i < 3; ++i) put(file, T.translation()(i));
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) put(file, sign * x);
}

// Upper triangle, row by row: 21 numbers.
void put_covariance(std::FILE* file, const Matrix6d& cov) {
  for (int row = 0; row < 6; ++row)
    for (int col = row; col < 6; ++col) put(file, cov(row, col));
}

std::string covariance_header(const std::string& prefix) {
  std::string header;
  for (int row = 0; row < 6; ++row)
    for (int col = row; col < 6; ++col) header += "," + prefix + std::to_string(row) + std::to_string(col);
  return header;
}

// Deviation of one coordinate, averaged over the three directions.
double sigma_of_block(const Matrix6d& cov, int first) {
  return std::sqrt(std::max(0.0, cov.block<3, 3>(first, first).trace() / 3.0));
}

void write_camera(std::FILE* file, const FrameResult& result) {
  const Rigid3& T_world_cam = result.T_world_cam;
  Eigen::Quaterniond q = Eigen::Quaterniond(T_world_cam.linear()).normalized();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const std::int64_t ns = result.capture_time.ns;
  std::fprintf(file, "%" PRId64 ".%09" PRId64 " %.12g %.12g %.12g %.12g %.12g %.12g %.12g\n", ns / 1000000000,
               ns % 1000000000, T_world_cam.translation().x(), T_world_cam.translation().y(),
               T_world_cam.translation().z(), q.x(), q.y(), q.z(), q.w());
}

void write_object(std::FILE* file, Timestamp capture_time, const ObjectState& object) {
  std::fprintf(file, "%" PRId64 ",%d,%s", capture_time.ns, object.id.value, to_text(object.phase));
  put_rigid(file, object.T_world_obj);
  put_rigid(file, object.M_world);
  const Matrix6d cov_centroid = motion_covariance_at_centroid(object);
  std::fprintf(file, ",%d", object.points);
  put(file, sigma_of_block(cov_centroid, 0));
  put(file, sigma_of_block(cov_centroid, 3));
  for (int i = 0; i < 3; ++i) put(file, object.centroid_world(i));
  for (int i = 0; i < 3; ++i) put(file, object.extent_m(i));
  put_covariance(file, cov_centroid);
  std::fputc('\n', file);
}

std::string objects_header() {
  return "timestamp_ns,object_id,state,p_x,p_y,p_z,q_w,q_x,q_y,q_z,m_x,m_y,m_z,mq_w,mq_x,mq_y,mq_z,points,"
         "sigma_t_m,sigma_r_rad,c_x,c_y,c_z,e_x,e_y,e_z" +
         covariance_header("m_cov_");
}

std::string frames_header() {
  std::string header = "seq,timestamp_ns,state,pose_valid";
  for (std::size_t i = 0; i < kStageCount; ++i) header += std::string(",") + to_text(static_cast<Stage>(i));
  header +=
      ",points_tracked,points_started,points_static,points_moving,points_outlier,groups,objects,frames_missed,births_"
      "refused,"
      "sigma_px,world_confidence,reset_counter,pose_sigma_t_m,pose_sigma_r_rad,"
      "step_x,step_y,step_z,stepq_w,stepq_x,stepq_y,stepq_z";
  return header + covariance_header("step_cov_");
}

std::string timing_header() {
  std::string header = "seq,timestamp_ns,read_us,rectify_us,step_us";
  for (std::size_t i = 0; i < kStageCount; ++i) header += std::string(",") + to_text(static_cast<Stage>(i)) + "_us";
  return header;
}

Error io_error(const fs::path& path, const std::string& detail, const std::string& cure) {
  return {ErrorCode::io, path.string(), detail, cure};
}

// Under the names that `pelorus export` gives: beside another run they would be taken for its own.
std::vector<fs::path> exports_in(const fs::path& folder) {
  static const std::regex kNames(
      R"(run\.mcap|trajectories\.csv|scene\.ply|body_\d+\.ply|(camera|body_\d+)\.(export\.tum|kitti\.txt.*))");
  std::vector<fs::path> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (std::regex_match(entry.path().filename().string(), kNames)) found.push_back(entry.path());
  }
  return found;
}

Result<Ok> remove_earlier_run(const fs::path& folder) {
  const ResultPaths paths(folder);
  std::error_code error;
  std::vector<fs::path> old = exports_in(folder);
  old.insert(old.end(), {paths.camera, paths.objects, paths.frames, paths.timing, paths.points, paths.outlines,
                         paths.lost_pairs, paths.overlay, paths.report, paths.incomplete});
  for (const fs::path& path : old) {
    fs::remove_all(path, error);
    if (error) return io_error(path, "cannot remove the earlier run: " + error.message(), "choose another --out");
  }
  return Ok{};
}

}  // namespace

Matrix6d motion_covariance_at_centroid(const ObjectState& object) {
  Rigid3 T_centroid_world = Rigid3::Identity();
  T_centroid_world.translation() = -object.centroid_world;
  const Matrix6d Ad = adjoint(T_centroid_world);
  return Ad * object.cov_M_world * Ad.transpose();
}

Result<Ok> prepare_output_folder(const fs::path& folder, bool overwrite) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    return io_error(folder, "the output is a file, not a folder", "give --out a folder");
  }
  fs::create_directories(folder, error);
  if (error) return io_error(folder, "cannot create the output folder: " + error.message(), "check path and rights");
  const bool empty = fs::is_empty(folder, error);
  if (error) return io_error(folder, "cannot look into the output folder: " + error.message(), "check its rights");
  if (empty) return Ok{};
  if (!overwrite) {
    return io_error(folder, "the output folder is not empty", "choose another --out, or pass --overwrite");
  }
  return remove_earlier_run(folder);
}

Result<ResultFile> ResultFile::create(const fs::path& path, const std::string& header) {
  ResultFile output;
  output.path_ = path;
  output.file_.reset(std::fopen(path.c_str(), "wb"));
  if (!output.file_) {
    return io_error(path, std::string("cannot create the file: ") + std::strerror(errno),
                    "check the folder's rights and free space");
  }
  if (!header.empty()) std::fprintf(output.file_.get(), "%s\n", header.c_str());
  if (Result<Ok> flushed = output.flush(); !flushed) return flushed.error();
  return output;
}

Result<Ok> ResultFile::flush() const {
  if (std::fflush(file_.get()) == 0 && std::ferror(file_.get()) == 0) return Ok{};
  return io_error(path_, std::string("cannot write: ") + std::strerror(errno),
                  "free space on the device; what was written before is complete");
}

Result<ResultWriter> ResultWriter::create(const fs::path& folder) {
  const ResultPaths paths(folder);
  ResultWriter writer;
  const auto open_into = [](ResultFile& output, const fs::path& path, const std::string& header) -> Result<Ok> {
    Result<ResultFile> opened = ResultFile::create(path, header);
    if (!opened) return opened.error();
    output = std::move(opened.value());
    return Ok{};
  };
  // camera.tum has no header: the TUM tools read every line as a pose.
  if (auto done = open_into(writer.camera_, paths.camera, ""); !done) return done.error();
  if (auto done = open_into(writer.objects_, paths.objects, objects_header()); !done) return done.error();
  if (auto done = open_into(writer.frames_, paths.frames, frames_header()); !done) return done.error();
  if (auto done = open_into(writer.timing_, paths.timing, timing_header()); !done) return done.error();
  return writer;
}

void ResultWriter::write_frame(const FrameResult& result) {
  std::FILE* file = frames_.get();
  std::fprintf(file, "%" PRIu64 ",%" PRId64 ",%s,%d", result.seq, result.capture_time.ns, to_text(result.state),
               result.pose_valid ? 1 : 0);
  const FrameReport& report = result.report;
  for (const StageReport& stage : report.stages) std::fprintf(file, ",%s", to_text(stage.outcome));
  std::fprintf(file, ",%d,%d,%d,%d,%d,%d,%d,%d,%d", report.points_tracked, report.points_started, report.points_static,
               report.points_moving, report.points_outlier, report.groups, result.objects_size, report.frames_missed,
               report.births_refused);
  put(file, report.sigma_px);
  put(file, result.world_confidence);
  std::fprintf(file, ",%d", result.reset_counter);
  put(file, sigma_of_block(result.cov_T_world_cam, 0));
  put(file, sigma_of_block(result.cov_T_world_cam, 3));
  put_rigid(file, result.T_curr_prev);
  put_covariance(file, result.cov_T_curr_prev);
  std::fputc('\n', file);
}

void ResultWriter::write_timing(const FrameResult& result, const FrameTiming& timing) {
  std::FILE* file = timing_.get();
  std::fprintf(file, "%" PRIu64 ",%" PRId64 ",%" PRId64 ",%" PRId64 ",%" PRId64, result.seq, result.capture_time.ns,
               timing.read_us, timing.rectify_us, timing.step_us);
  for (const StageReport& stage : result.report.stages) std::fprintf(file, ",%d", stage.microseconds);
  std::fputc('\n', file);
}

Result<Ok> ResultWriter::append(const FrameResult& result, const FrameTiming& timing) {
  if (result.pose_valid) write_camera(camera_.get(), result);
  for (const ObjectState& object : result.objects_view()) {
    write_object(objects_.get(), result.capture_time, object);
  }
  write_frame(result);
  write_timing(result, timing);
  for (const ResultFile* output : {&camera_, &objects_, &frames_, &timing_}) {
    if (Result<Ok> flushed = output->flush(); !flushed) return flushed.error();
  }
  return Ok{};
}

}  // namespace pelorus
