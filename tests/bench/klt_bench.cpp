// Our tracker beside cv::calcOpticalFlowPyrLK in one run: 15 x 15 window, 4 levels, the same stop criteria, pyramids
// included, one thread each. 600 points left to left; 600 points left to right along the row.

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
  std::vector<cv::Point2f> points;
  std::string where;
};

const Scene& scene() {
  static const Scene s = [] {
    Scene made;
    made.from = bench::load_or_render("kitti_odometry/06_first41/image_0/000000.png", 1024, 768, made.where);
    made.to = cv::imread((bench::data_dir() / "kitti_odometry/06_first41/image_0/000001.png").string(), 0);
    if (made.to.empty()) {
      const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 3.3, 0, 1, -2.2);
      cv::warpAffine(made.from, made.to, shift, made.from.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    }
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

// One new pyramid a frame: the previous one is kept.
void ours(benchmark::State& state, KltSearch search, int coarsest) {
  const Scene& s = scene();
  const Klt klt({});
  ImagePyramid from;
  ImagePyramid to;
  from.build(bench::view(s.from), kLevels);
  const std::vector<KltTask> start = tasks_of(s);
  std::vector<KltTask> tasks = start;
  int ok = 0;
  for (auto _ : state) {
    tasks = start;
    to.build(bench::view(s.to), kLevels);
    klt.track(from, to, tasks, search, coarsest);
  }
  for (const KltTask& t : tasks) ok += t.outcome == KltOutcome::ok ? 1 : 0;
  state.counters["points"] = static_cast<double>(tasks.size());
  state.counters["ok"] = ok;
}

void opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  const Scene& s = scene();
  std::vector<cv::Mat> from;
  std::vector<cv::Mat> to;
  cv::buildOpticalFlowPyramid(s.from, from, {15, 15}, kLevels - 1);
  std::vector<cv::Point2f> end;
  std::vector<unsigned char> found;
  std::vector<float> error;
  for (auto _ : state) {
    cv::buildOpticalFlowPyramid(s.to, to, {15, 15}, kLevels - 1);  // with derivatives, used in the next frame
    cv::calcOpticalFlowPyrLK(from, to, s.points, end, found, error, {15, 15}, kLevels - 1,
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 12, 0.005});
  }
  state.counters["points"] = static_cast<double>(s.points.size());
}

}  // namespace

BENCHMARK(pyramid)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ours, plane, KltSearch::plane, kLevels - 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ours, plane_predicted, KltSearch::plane, 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ours, row, KltSearch::row, kLevels - 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ours, slanted_row, KltSearch::slanted_row, kLevels - 1)->Unit(benchmark::kMillisecond);
BENCHMARK(opencv)->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
