#include "firmware-host/pelorus/results/result_reader.h"

#include <algorithm>
#include <array>
#include <map>

#include "core/base/nearest_rank.h"
#include "firmware-host/pelorus/results/incomplete_mark.h"
#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/pelorus/results/result_reader_table.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

Error missing_column(const fs::path& file, const std::string& name) {
  return {ErrorCode::bad_input, file.string() + ":1", "column '" + name + "' is missing",
          "the file is not one that `pelorus replay` writes"};
}

template <class Enum, std::size_t N>
std::optional<Enum> from_text(const std::string& text, const std::array<Enum, N>& all) {
  for (const Enum value : all)
    if (text == to_text(value)) return value;
  return std::nullopt;
}

constexpr std::array<VisionState, 7> kStates = {
    VisionState::init,         VisionState::tracking,          VisionState::degraded, VisionState::lost,
    VisionState::camera_fault, VisionState::calibration_fault, VisionState::standby};
constexpr std::array<ObjectPhase, 4> kPhases = {ObjectPhase::tentative, ObjectPhase::confirmed, ObjectPhase::coasting,
                                                ObjectPhase::ended};

// 21 columns of the upper triangle, from `column` on.
Matrix6d covariance(TextTable& table, std::size_t row, std::size_t column) {
  Matrix6d cov;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) cov(r, c) = cov(c, r) = table.number(row, column++);
  }
  return cov;
}

// What frames.csv says that the other files hold of each frame. A file that was cut at the end of a line, or emptied,
// shows in nothing else. Empty lists where the file is not ours and does not say.
struct FrameContents {
  std::vector<bool> has_pose;
  std::vector<std::int64_t> objects;
};

Result<EstimatedRun> read_frames(const fs::path& file, FrameContents& contents) {
  Result<TextTable> read = TextTable::read_of_run(file, TableHeader::first_line);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.blank()) return EstimatedRun();
  for (const char* name : {"seq", "timestamp_ns", "state"}) {
    if (!table.find(name)) return missing_column(file, name);
  }
  const auto step = table.find("step_x");
  const auto step_cov = table.find("step_cov_00");
  // The number of objects stands behind that of groups: a stage is called objects too.
  const auto pose = table.find("pose_valid"), groups = table.find("groups");
  EstimatedRun run;
  for (std::size_t row = 0; row < table.size(); ++row) {
    EstimatedFrame frame;
    frame.seq = static_cast<std::uint64_t>(table.integer(row, *table.find("seq")));
    frame.capture_time = Timestamp{table.integer(row, *table.find("timestamp_ns"))};
    const auto state = from_text(table.text(row, *table.find("state")), kStates);
    if (!state) table.complain(row, "'" + table.text(row, *table.find("state")) + "' is no state");
    frame.state = state.value_or(VisionState::init);
    if (step) frame.T_curr_prev = table.rigid(row, *step, true);
    if (step_cov) frame.cov_T_curr_prev = covariance(table, row, *step_cov);
    if (const auto column = table.find("world_confidence")) frame.world_confidence = table.number(row, *column);
    const auto count = [&](const char* name) {
      const auto column = table.find(name);
      return column ? static_cast<int>(table.integer(row, *column)) : 0;
    };
    if (pose) contents.has_pose.push_back(table.integer(row, *pose) != 0);
    if (groups && *groups + 1 < table.columns()) contents.objects.push_back(table.integer(row, *groups + 1));
    frame.reset_counter = count("reset_counter");
    frame.frames_missed = count("frames_missed");
    if (!run.empty() && frame.capture_time <= run.back().capture_time) table.complain(row, "time does not advance");
    if (table.problem()) return *table.problem();
    run.push_back(std::move(frame));
  }
  return run;
}

Error incomplete_file(const fs::path& file, const std::string& held, const std::string& expected) {
  return {ErrorCode::bad_input, file.string(), "holds " + held + ", frames.csv tells of " + expected,
          "the file was cut off or damaged: repeat the run"};
}

Result<Ok> check_contents(const ResultPaths& paths, const FrameContents& contents, const EstimatedRun& run) {
  const auto poses = std::count_if(run.begin(), run.end(), [](const EstimatedFrame& f) { return f.T_world_cam; });
  const auto expected = std::count(contents.has_pose.begin(), contents.has_pose.end(), true);
  if (!contents.has_pose.empty() && poses != expected)
    return incomplete_file(paths.camera, std::to_string(poses) + " poses", std::to_string(expected));
  for (std::size_t i = 0; i < contents.objects.size(); ++i) {
    const std::size_t held = run[i].objects.size();
    if (static_cast<std::int64_t>(held) == contents.objects[i]) continue;
    return incomplete_file(paths.objects, std::to_string(held) + " objects of frame " + std::to_string(run[i].seq),
                           std::to_string(contents.objects[i]));
  }
  return Ok{};
}

// How many frames a file holds whole that was cut off at its end: `held` rows of a frame, of `told` in frames.csv.
// Absent where other rows are missing or too many: that is damage, not a cut.
template <class Held, class Told>
std::optional<std::size_t> frames_before_cut(std::size_t frames, const Held& held, const Told& told) {
  std::size_t whole = 0;
  while (whole < frames && held(whole) == told(whole)) ++whole;
  if (whole < frames && held(whole) > told(whole)) return std::nullopt;
  for (std::size_t i = whole + 1; i < frames; ++i)
    if (held(i) > 0) return std::nullopt;
  return whole;
}

// A run that was killed ends with the last frame that all files hold.
void cut_run(FrameContents& contents, EstimatedRun& run, std::string& told) {
  using Count = std::int64_t;
  const auto poses = frames_before_cut(
      contents.has_pose.size(), [&](std::size_t i) { return Count{run[i].T_world_cam ? 1 : 0}; },
      [&](std::size_t i) { return Count{contents.has_pose[i] ? 1 : 0}; });
  const auto objects = frames_before_cut(
      contents.objects.size(), [&](std::size_t i) { return static_cast<Count>(run[i].objects.size()); },
      [&](std::size_t i) { return contents.objects[i]; });
  if (!poses || !objects) return;  // check_contents tells of it
  const std::size_t all = run.size();
  const std::size_t kept =
      std::min(contents.has_pose.empty() ? all : *poses, contents.objects.empty() ? all : *objects);
  if (kept == all) return;
  told = "cut to its first " + std::to_string(kept) + " of " + std::to_string(all) + " frames, where " +
         (contents.has_pose.size() > kept && *poses == kept ? "camera.tum" : "objects.csv") + " ends";
  run.erase(run.begin() + static_cast<std::ptrdiff_t>(kept), run.end());
  contents.has_pose.resize(std::min(kept, contents.has_pose.size()));
  contents.objects.resize(std::min(kept, contents.objects.size()));
}

// Written after the last frame of frames.csv, by a run that was killed before it could write that frame there.
bool is_ahead(Timestamp time, const EstimatedRun& run) { return run.empty() || time > run.back().capture_time; }

// Poses of camera.tum into the run; a run without frames.csv consists of them.
Result<Ok> read_camera(const fs::path& file, bool has_frames, bool killed, EstimatedRun& run) {
  Result<TextTable> read = TextTable::read_of_run(file, TableHeader::none);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.size() > 0 && table.columns() != 8) {
    return Error{ErrorCode::bad_input, file.string(), "a TUM trajectory has 8 columns", "see `pelorus replay --help`"};
  }
  std::map<Timestamp, std::size_t> frame_at;
  for (std::size_t i = 0; i < run.size(); ++i) frame_at[run[i].capture_time] = i;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const Timestamp time = table.time_of_seconds(row, 0);
    const Rigid3 T_world_cam = table.rigid(row, 1, false);
    if (!has_frames) {
      EstimatedFrame frame;
      frame.seq = row;
      frame.capture_time = time;
      frame.state = VisionState::tracking;
      frame.T_world_cam = T_world_cam;
      if (!run.empty() && time <= run.back().capture_time) table.complain(row, "time does not advance");
      run.push_back(std::move(frame));
    } else if (const auto found = frame_at.find(time); found != frame_at.end()) {
      run[found->second].T_world_cam = T_world_cam;
    } else if (!killed || !is_ahead(time, run)) {
      table.complain(row, "no frame of frames.csv has this time");
    }
    if (table.problem()) return *table.problem();
  }
  return Ok{};
}

EstimatedObject read_object(TextTable& table, std::size_t row) {
  EstimatedObject object;
  object.id = BodyId{static_cast<std::int32_t>(table.integer(row, *table.find("object_id")))};
  const auto phase = from_text(table.text(row, *table.find("state")), kPhases);
  if (!phase) table.complain(row, "'" + table.text(row, *table.find("state")) + "' is no state of an object");
  object.phase = phase.value_or(ObjectPhase::tentative);
  object.T_world_obj = table.rigid(row, *table.find("p_x"), true);
  object.M_world = table.rigid(row, *table.find("m_x"), true);
  object.points = static_cast<int>(table.integer(row, *table.find("points")));
  object.centroid_world = object.T_world_obj.translation();  // a file without c_x: the best there is
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (const auto c = table.find("c_x")) object.centroid_world(at) = table.number(row, *c + i);
    if (const auto e = table.find("e_x")) object.extent_m(at) = table.number(row, *e + i);
  }
  if (const auto cov = table.find("m_cov_00")) {
    object.cov_M_centroid = covariance(table, row, *cov);
  } else {
    const double sigma_t_m = table.number(row, *table.find("sigma_t_m"));
    const double sigma_r_rad = table.number(row, *table.find("sigma_r_rad"));
    object.cov_M_centroid.diagonal().head<3>().setConstant(sigma_t_m * sigma_t_m);
    object.cov_M_centroid.diagonal().tail<3>().setConstant(sigma_r_rad * sigma_r_rad);
  }
  return object;
}

Result<Ok> read_objects(const fs::path& file, bool killed, EstimatedRun& run) {
  Result<TextTable> read = TextTable::read_of_run(file, TableHeader::first_line);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.blank()) return Ok{};
  for (const char* name :
       {"timestamp_ns", "object_id", "state", "p_x", "q_w", "m_x", "mq_w", "points", "sigma_t_m", "sigma_r_rad"}) {
    if (!table.find(name)) return missing_column(file, name);
  }
  std::map<Timestamp, std::size_t> frame_at;
  for (std::size_t i = 0; i < run.size(); ++i) frame_at[run[i].capture_time] = i;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const Timestamp time{table.integer(row, *table.find("timestamp_ns"))};
    if (killed && is_ahead(time, run)) continue;
    const auto found = frame_at.find(time);
    if (found == frame_at.end()) table.complain(row, "no frame has this time");
    const EstimatedObject object = read_object(table, row);
    if (table.problem()) return *table.problem();
    run[found->second].objects.push_back(object);
  }
  return Ok{};
}

}  // namespace

Result<EstimatedRun> read_run(const fs::path& folder, std::string* cut) {
  const ResultPaths paths(folder);
  std::error_code ignored;
  if (!fs::is_regular_file(paths.camera, ignored)) {
    return Error{ErrorCode::bad_input, folder.string(), "no camera.tum here", "give the --out folder of a replay"};
  }
  const bool killed = incomplete_reason(folder).has_value();
  EstimatedRun run;
  FrameContents contents;
  const bool has_frames = fs::is_regular_file(paths.frames, ignored);
  if (has_frames) {
    Result<EstimatedRun> frames = read_frames(paths.frames, contents);
    if (!frames) return frames.error();
    run = std::move(frames.value());
  }
  if (Result<Ok> read = read_camera(paths.camera, has_frames, killed, run); !read) return read.error();
  if (fs::is_regular_file(paths.objects, ignored)) {
    if (Result<Ok> read = read_objects(paths.objects, killed, run); !read) return read.error();
  }
  std::string told;
  if (killed) cut_run(contents, run, told);
  if (run.empty()) {
    return Error{ErrorCode::bad_input, folder.string(), "the run holds no frame", "repeat the replay"};
  }
  if (Result<Ok> fit = check_contents(paths, contents, run); !fit) return fit.error();
  if (cut) *cut = told;
  return run;
}

Result<std::optional<StepTimes>> read_step_times(const fs::path& folder) {
  const fs::path file = ResultPaths(folder).timing;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::optional<StepTimes>();
  Result<TextTable> read = TextTable::read_of_run(file, TableHeader::first_line);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.blank()) return std::optional<StepTimes>();
  const auto column = table.find("step_us");
  if (!column) return missing_column(file, "step_us");
  std::vector<double> times_ms;
  for (std::size_t row = 0; row < table.size(); ++row) times_ms.push_back(table.number(row, *column) * 1e-3);
  if (table.problem()) return *table.problem();
  if (times_ms.empty()) return std::optional<StepTimes>();
  std::sort(times_ms.begin(), times_ms.end());
  return std::optional<StepTimes>(StepTimes{nearest_rank(times_ms, 0.5), nearest_rank(times_ms, 0.99)});
}

}  // namespace pelorus
