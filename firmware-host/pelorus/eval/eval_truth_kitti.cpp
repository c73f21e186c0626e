#include <algorithm>
#include <cmath>
#include <map>

#include "drivers/replay/kitti.h"
#include "firmware-host/pelorus/eval/eval_truth_layouts.h"
#include "firmware-host/pelorus/results/result_reader_table.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

// Line of the truth file = running number of the image; the run knows times, the recording both.
Result<std::map<Timestamp, std::size_t>> index_by_time(Result<Recording> recording) {
  if (!recording) return recording.error();
  std::map<Timestamp, std::size_t> index;
  for (const RecordedImage& image : recording.value().left) index[image.time] = static_cast<std::size_t>(image.index);
  return index;
}

Result<std::optional<Truth>> read_poses(const fs::path& file, Result<Recording> recording, const EstimatedRun& run) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::optional<Truth>();
  const auto index = index_by_time(std::move(recording));
  if (!index) return index.error();
  Result<TextTable> read = TextTable::read(file, TableHeader::none);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.size() > 0 && table.columns() != 12) {
    return Error{ErrorCode::bad_input, file.string(), "a KITTI pose has 12 numbers", "check the file"};
  }
  Truth truth;
  truth.frames.resize(run.size());
  for (std::size_t i = 0; i < run.size(); ++i) {
    const auto found = index.value().find(run[i].capture_time);
    if (found == index.value().end() || found->second >= table.size()) continue;
    truth.frames[i].T_truth_cam = table.rigid_from_matrix(found->second, 0);
  }
  if (table.problem()) return *table.problem();
  return std::optional<Truth>(std::move(truth));
}

// Columns of KITTI tracking labels (Geiger et al. 2012, devkit of the tracking benchmark).
enum LabelColumn : std::size_t {
  kFrame,
  kTrack,
  kType,
  kTruncated,
  kOccluded,
  kAlpha,
  kLeft,
  kTop,
  kRight,
  kBottom,
  kHeight,
  kWidth,
  kLength,
  kX,
  kY,
  kZ,
  kTurn,
  kLabelColumns
};

// The box's centre: labels give the middle of its bottom face. Body axes: x along the length, y down, z along the
// width.
TrueBodyView read_label(TextTable& table, std::size_t row) {
  TrueBodyView view;
  const double height_m = table.number(row, kHeight);
  const double width_m = table.number(row, kWidth);
  const double length_m = table.number(row, kLength);
  view.T_cam_body.translation() << table.number(row, kX), table.number(row, kY) - 0.5 * height_m, table.number(row, kZ);
  view.T_cam_body.linear() = so3_exp({0, table.number(row, kTurn), 0});
  view.half_size_m = 0.5 * Eigen::Vector3d(length_m, height_m, width_m);
  // The share that shows is guessed from the level of occlusion: 0 none, 1 partly, 2 largely, 3 unknown.
  constexpr std::array<double, 4> kShareSeen = {1.0, 0.6, 0.2, 0.0};
  const auto level = static_cast<std::size_t>(std::clamp<std::int64_t>(table.integer(row, kOccluded), 0, 3));
  const double area_px =
      (table.number(row, kRight) - table.number(row, kLeft)) * (table.number(row, kBottom) - table.number(row, kTop));
  view.visible_px = static_cast<int>(area_px * kShareSeen[level]);
  return view;
}

struct Track {
  std::string name;
  std::map<std::size_t, TrueBodyView> views;  // by image number
};

Result<std::map<std::int64_t, Track>> read_tracks(const fs::path& file) {
  Result<TextTable> read = TextTable::read(file, TableHeader::none);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.size() > 0 && table.columns() < kLabelColumns) {
    return Error{ErrorCode::bad_input, file.string(), "a tracking label has 17 columns", "check the file"};
  }
  std::map<std::int64_t, Track> tracks;
  for (std::size_t row = 0; row < table.size(); ++row) {
    if (table.text(row, kType) == "DontCare") continue;
    const std::int64_t id = table.integer(row, kTrack);
    Track& track = tracks[id];
    track.name = table.text(row, kType) + " " + std::to_string(id);
    track.views[static_cast<std::size_t>(table.integer(row, kFrame))] = read_label(table, row);
    if (table.problem()) return *table.problem();
  }
  return tracks;
}

// Labels and GPS are too rough to tell a single step from rest; the mean speed over the whole track is not: parked cars
// come out below 0.1 m/s, the slowest walker above 0.6 m/s.
constexpr double kResting_m_per_s = 0.3;

bool is_moving(const Track& track, int body, const EstimatedRun& run, const Truth& truth) {
  std::optional<std::pair<Timestamp, Eigen::Vector3d>> first;
  double speed = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const TrueBodyView* view = truth.frames[i].find(body);
    if (!view || !truth.frames[i].T_truth_cam) continue;
    const Eigen::Vector3d p_truth = (*truth.frames[i].T_truth_cam * view->T_cam_body).translation();
    if (!first) first = {run[i].capture_time, p_truth};
    const double passed_s = seconds(run[i].capture_time - first->first);
    if (passed_s > 0) speed = (p_truth - first->second).norm() / passed_s;
  }
  return !track.views.empty() && speed > kResting_m_per_s;
}

}  // namespace

Result<std::optional<Truth>> read_kitti_odometry_truth(const fs::path& folder, const EstimatedRun& run) {
  Result<std::optional<Truth>> truth = read_poses(folder / "poses.txt", list_kitti_odometry(folder), run);
  if (truth.ok() && truth.value()) truth.value()->origin = "KITTI poses (GPS/INS, centimetres from frame to frame)";
  return truth;
}

Result<std::optional<Truth>> read_kitti_raw_truth(const fs::path& folder, const EstimatedRun& run) {
  Result<std::optional<Truth>> truth = read_poses(folder / "poses_cam0_from_oxts.txt", list_kitti_raw(folder), run);
  if (!truth || !truth.value()) return truth;
  Truth& known = *truth.value();
  known.origin = "KITTI GPS/INS and hand-made boxes: scale to 5 %, objects for their identity rather than their motion";
  known.scale_known = false;
  const fs::path labels = folder / "tracking_label_02.txt";
  std::error_code ignored;
  if (!fs::is_regular_file(labels, ignored)) return truth;
  Result<std::map<std::int64_t, Track>> tracks = read_tracks(labels);
  if (!tracks) return tracks.error();
  const auto index = index_by_time(list_kitti_raw(folder));
  if (!index) return index.error();
  known.knows_bodies = true;
  for (const auto& [id, track] : tracks.value()) {
    const int body = static_cast<int>(known.bodies.size());
    known.bodies.push_back(track.name);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const auto number = index.value().find(run[i].capture_time);
      if (number == index.value().end()) continue;
      const auto found = track.views.find(number->second);
      if (found == track.views.end()) continue;
      known.frames[i].bodies.push_back(found->second);
      known.frames[i].bodies.back().body = body;
    }
    const bool moving = is_moving(track, body, run, known);
    for (TrueFrame& frame : known.frames) {
      for (TrueBodyView& view : frame.bodies) {
        if (view.body == body) view.moving = moving;
      }
    }
  }
  return truth;
}

}  // namespace pelorus
