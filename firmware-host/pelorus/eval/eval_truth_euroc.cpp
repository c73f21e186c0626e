#include <algorithm>
#include <fstream>
#include <map>

#include "firmware-host/pelorus/eval/eval_truth_layouts.h"
#include "firmware-host/pelorus/progress_bar.h"
#include "firmware-host/pelorus/results/result_reader_table.h"
#include "firmware-host/pelorus/synth/asl_writer.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

// Between two samples further apart than this nothing is interpolated: the truth has a hole there.
constexpr std::int64_t kLongestInterpolation_ns = 100'000'000;
// Exported stamps may be rounded to microseconds.
constexpr std::int64_t kSameTime_ns = 1'000;

struct TimedRow {
  Timestamp time;
  Rigid3 T = Rigid3::Identity();
  int visible_px = -1;
};

// Rows `timestamp_ns, p, q (w first), ...` in order of time.
Result<std::vector<TimedRow>> read_timed_rows(const fs::path& file) {
  Result<TextTable> read = TextTable::read(file, TableHeader::none);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.size() > 0 && table.columns() < 8) {
    return Error{ErrorCode::bad_input, file.string(), "truth needs time, position and quaternion: 8 columns", ""};
  }
  std::vector<TimedRow> rows;
  for (std::size_t row = 0; row < table.size(); ++row) {
    TimedRow timed{Timestamp{table.integer(row, 0)}, table.rigid(row, 1, true), -1};
    if (table.columns() == 9) timed.visible_px = static_cast<int>(table.integer(row, 8));
    if (!rows.empty() && timed.time <= rows.back().time) table.complain(row, "time does not advance");
    if (table.problem()) return *table.problem();
    rows.push_back(timed);
  }
  return rows;
}

std::optional<TimedRow> at_time(const std::vector<TimedRow>& rows, Timestamp time) {
  const auto after =
      std::lower_bound(rows.begin(), rows.end(), time, [](const TimedRow& r, Timestamp t) { return r.time < t; });
  const auto is_same = [&](const TimedRow& row) { return std::abs((row.time - time).count()) <= kSameTime_ns; };
  if (after != rows.end() && is_same(*after)) return *after;
  if (after != rows.begin() && is_same(*std::prev(after))) return *std::prev(after);
  if (after == rows.begin() || after == rows.end()) return std::nullopt;
  const TimedRow& before = *std::prev(after);
  const auto span_ns = (after->time - before.time).count();
  if (span_ns > kLongestInterpolation_ns) return std::nullopt;
  const double share = static_cast<double>((time - before.time).count()) / static_cast<double>(span_ns);
  TimedRow between = before;
  between.time = time;
  between.T.translation() += share * (after->T.translation() - before.T.translation());
  between.T.linear() =
      Eigen::Quaterniond(before.T.linear()).slerp(share, Eigen::Quaterniond(after->T.linear())).toRotationMatrix();
  return between;
}

struct BodyBox {
  std::string name;
  std::optional<Eigen::Vector3d> half_size_m;
};

// body.csv beside the poses: optional, ours.
Result<BodyBox> read_body_box(const fs::path& folder) {
  BodyBox box{folder.filename().string(), std::nullopt};
  const fs::path file = folder / "body.csv";
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return box;
  Result<TextTable> read = TextTable::read(file, TableHeader::none);
  if (!read) return read.error();
  TextTable& table = read.value();
  if (table.size() != 1 || table.columns() != 4) {
    return Error{ErrorCode::bad_input, file.string(), "a body is one line: name and three sizes", "check the file"};
  }
  box.name = table.text(0, 0);
  box.half_size_m = 0.5 * Eigen::Vector3d(table.number(0, 1), table.number(0, 2), table.number(0, 3));
  if (table.problem()) return *table.problem();
  return box;
}

Result<Ok> add_body(const fs::path& file, const EstimatedRun& run, Truth& truth) {
  Result<std::vector<TimedRow>> rows = read_timed_rows(file);
  if (!rows) return rows.error();
  const int body = static_cast<int>(truth.bodies.size());
  const Result<BodyBox> box = read_body_box(file.parent_path());
  if (!box) return box.error();
  truth.bodies.push_back(box.value().name);
  for (std::size_t i = 0; i < run.size(); ++i) {
    TrueFrame& frame = truth.frames[i];
    const std::optional<TimedRow> row = at_time(rows.value(), run[i].capture_time);
    if (!row || !frame.T_truth_cam) continue;
    TrueBodyView view;
    view.body = body;
    view.T_cam_body = frame.T_truth_cam->inverse() * row->T;
    view.half_size_m = box.value().half_size_m;
    if (row->visible_px >= 0) view.visible_px = row->visible_px;
    frame.bodies.push_back(view);
  }
  return Ok{};
}

}  // namespace

Result<std::optional<Truth>> read_euroc_truth(const fs::path& mav0, const Rigid3& T_body_cam, const EstimatedRun& run) {
  const fs::path file = mav0 / "state_groundtruth_estimate0" / "data.csv";
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::optional<Truth>();
  Result<std::vector<TimedRow>> rows = read_timed_rows(file);
  if (!rows) return rows.error();
  Truth truth;
  truth.exact = is_synthetic_dive(mav0);  // complete even where no object folder exists
  truth.knows_bodies = truth.exact;
  truth.origin = truth.exact ? "synthetic, exact" : "EuRoC state estimate (motion capture, millimetres)";
  truth.frames.resize(run.size());
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (const auto row = at_time(rows.value(), run[i].capture_time)) truth.frames[i].T_truth_cam = row->T * T_body_cam;
  }
  for (int k = 1;; ++k) {
    const fs::path object = mav0 / ("object" + std::to_string(k)) / "data.csv";
    if (!fs::is_regular_file(object, ignored)) break;
    truth.knows_bodies = true;
    if (Result<Ok> added = add_body(object, run, truth); !added) return added.error();
  }
  mark_moving_bodies(truth);
  return std::optional<Truth>(std::move(truth));
}

Truth scene_truth(synthetic::SyntheticSource& source, const EstimatedRun& run) {
  Truth truth;
  truth.exact = truth.knows_bodies = true;
  truth.origin = "synthetic, exact";
  truth.frames.resize(run.size());
  std::map<Timestamp, int> scene_frame;
  for (int i = 0; i < source.scene().frames; ++i) scene_frame[source.capture_time(i)] = i;
  for (int k = 0; k < source.object_count(); ++k) truth.bodies.push_back(source.object_body(k).name);
  SourcePair pair;
  ProgressBar bar("rendering the truth", run.size(), "frames");
  for (std::size_t i = 0; i < run.size(); ++i) {
    const auto found = scene_frame.find(run[i].capture_time);
    if (found == scene_frame.end()) continue;
    const int frame = found->second;
    if (source.object_count() > 0) source.render(frame, pair);
    truth.frames[i].T_truth_cam = source.T_world_cam(frame);
    for (int k = 0; k < source.object_count(); ++k) {
      TrueBodyView view;
      view.body = k;
      view.T_cam_body = source.T_world_cam(frame).inverse() * source.T_world_obj(k, frame);
      view.half_size_m = 0.5 * source.object_body(k).size_m;
      view.visible_px = source.visible_px(k);
      truth.frames[i].bodies.push_back(view);
    }
    bar.update(i + 1);
  }
  mark_moving_bodies(truth);
  return truth;
}

}  // namespace pelorus
