// Our tracker beside cv::calcOpticalFlowPyrLK in one run: 15 x 15 window, 4 levels, the same stop criteria, one thread
// each. `step_*` is what a stereo step costs: 600 points left to left and the same 600 left to right, none predicted,
// with the pyramids of the new pair (the previous left one is kept). The others are parts of it. Run with
//   klt_bench --benchmark_enable_random_interleaving=true --benchmark_repetitions=9
//   --benchmark_report_aggregates_only=true
// and compare medians of CPU time.

#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "core/frontend/klt.h"
#include "tests/bench/test_images.h"

namespace {

using namespace pelorus;

constexpr int kLevels = 4;
constexpr int kPoints = 600;

struct Scene {
  cv::Mat from;
  cv::Mat to;
  cv::Mat right;  // of the pair of `from`
  std::vector<cv::Point2f> points;
  std::string where;
};

const Scene& scene() {
  static const Scene s = [] {
    Scene made;
    made.from = bench::load_or_render("kitti_odometry/06_first41/image_0/000000.png", 1024, 768, made.where);
    made.to = cv::imread((bench::data_dir() / "kitti_odometry/06_first41/image_0/000001.png").string(), 0);
    made.right = cv::imread((bench::data_dir() / "kitti_odometry/06_first41/image_1/000000.png").string(), 0);
    const auto shifted = [&](double du, double dv) {
      const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, du, 0, 1, dv);
      cv::Mat moved;
      cv::warpAffine(made.from, moved, shift, made.from.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
      return moved;
    };
    if (made.to.empty()) made.to = shifted(3.3, -2.2);
    if (made.right.empty()) made.right = shifted(-12.6, 0);
    cv::goodFeaturesToTrack(made.from, made.points, kPoints, 0.001, 8);
    return made;
  }();
  return s;
}

std::vector<KltTask> tasks_of(const Scene& s) {
  std::vector<KltTask> tasks(s.points.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    tasks[i].u_from_px = tasks[i].u_to_px = s.points[i].x;
    tasks[i].v_from_px = tasks[i].v_to_px = s.points[i].y;
  }
  return tasks;
}

void pyramid(benchmark::State& state) {
  ImagePyramid p;
  for (auto _ : state) p.build(bench::view(scene().from), kLevels);
  state.SetLabel(scene().where);
}

void count_ok(benchmark::State& state, const std::vector<KltTask>& tasks) {
  int ok = 0;
  for (const KltTask& t : tasks) ok += t.outcome == KltOutcome::ok ? 1 : 0;
  state.counters["points"] = static_cast<double>(tasks.size());
  state.counters["ok"] = ok;
}

void search_only(benchmark::State& state, bool across, KltSearch search, int coarsest) {
  const Scene& s = scene();
  const Klt klt({});
  ImagePyramid from;
  ImagePyramid to;
  from.build(bench::view(s.from), kLevels);
  to.build(bench::view(across ? s.right : s.to), kLevels);
  const std::vector<KltTask> start = tasks_of(s);
  std::vector<KltTask> tasks = start;
  for (auto _ : state) {
    tasks = start;
    klt.track(from, to, tasks, search, coarsest);
  }
  count_ok(state, tasks);
}

void step_ours(benchmark::State& state, KltSearch across) {
  const Scene& s = scene();
  const Klt klt({});
  ImagePyramid prev;
  ImagePyramid curr;
  ImagePyramid right;
  prev.build(bench::view(s.to), kLevels);
  const std::vector<KltTask> start = tasks_of(s);
  std::vector<KltTask> tasks = start;
  for (auto _ : state) {
    curr.build(bench::view(s.from), kLevels);
    right.build(bench::view(s.right), kLevels);
    tasks = start;
    klt.track(prev, curr, tasks, KltSearch::plane, kLevels - 1);
    tasks = start;
    klt.track(curr, right, tasks, across, kLevels - 1);
  }
  count_ok(state, tasks);
  state.SetLabel(s.where);
}

void step_opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  const Scene& s = scene();
  const cv::Size window{15, 15};
  const cv::TermCriteria stop{cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 12, 0.005};
  std::vector<cv::Mat> prev;
  std::vector<cv::Mat> curr;
  std::vector<cv::Mat> right;
  cv::buildOpticalFlowPyramid(s.to, prev, window, kLevels - 1);
  std::vector<cv::Point2f> end;
  std::vector<unsigned char> found;
  std::vector<float> error;
  for (auto _ : state) {
    cv::buildOpticalFlowPyramid(s.from, curr, window, kLevels - 1);           // with derivatives: searched from
    cv::buildOpticalFlowPyramid(s.right, right, window, kLevels - 1, false);  // searched in only
    cv::calcOpticalFlowPyrLK(prev, curr, s.points, end, found, error, window, kLevels - 1, stop);
    cv::calcOpticalFlowPyrLK(curr, right, s.points, end, found, error, window, kLevels - 1, stop);
  }
  state.counters["points"] = static_cast<double>(s.points.size());
}

void pyramid_opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  std::vector<cv::Mat> levels;
  for (auto _ : state) cv::buildOpticalFlowPyramid(scene().from, levels, {15, 15}, kLevels - 1);
}

}  // namespace

BENCHMARK(pyramid)->Unit(benchmark::kMillisecond);
BENCHMARK(pyramid_opencv)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(search_only, left_to_left, false, KltSearch::plane, kLevels - 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(search_only, row, true, KltSearch::row, kLevels - 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(search_only, slanted_row, true, KltSearch::slanted_row, kLevels - 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step_ours, row, KltSearch::row)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step_ours, slanted_row, KltSearch::slanted_row)->Unit(benchmark::kMillisecond);
BENCHMARK(step_opencv)->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
