// Our SURF beside dlib's in one run, one thread each: 752 x 480, the threshold searched until either finds the wanted
// number of points. Both sample the first octave at every second pixel; 64 floats.

#include <benchmark/benchmark.h>
#include <dlib/image_keypoint.h>

#include <algorithm>
#include <vector>

#include "core/frontend/surf.h"
#include "core/frontend/surf_match.h"
#include "core/kernels/integral_image.h"
#include "tests/bench/test_images.h"

namespace {

using namespace pelorus;

struct Scene {
  cv::Mat image;
  std::string where;
};

const Scene& scene() {
  static const Scene s = [] {
    const auto folder = bench::data_dir() / "euroc/V1_01_easy_first40/mav0/cam0/data";
    std::error_code none;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder, none)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    Scene made;
    made.image = files.empty() ? cv::Mat() : cv::imread(files.front().string(), cv::IMREAD_GRAYSCALE);
    made.where = made.image.empty() ? "rendered" : files.front().filename().string();
    if (made.image.empty()) made.image = bench::rendered(752, 480);
    return made;
  }();
  return s;
}

SurfConfig config_for(int points, bool upright, int step) {
  SurfConfig config;
  config.threshold = 1.0F;
  config.max_points = points;
  config.upright = upright;
  config.sampling_step = step;
  return config;
}

void integral(benchmark::State& state) {
  IntegralImage sums(scene().image.cols, scene().image.rows, 2);
  for (auto _ : state) sums.build(bench::view(scene().image));
}

void detect(benchmark::State& state, bool upright, int step) {
  const Scene& s = scene();
  Surf surf(config_for(static_cast<int>(state.range(0)), upright, step), s.image.cols, s.image.rows);
  std::size_t found = 0;
  for (auto _ : state) found = surf.detect(bench::view(s.image)).size();
  state.counters["points"] = static_cast<double>(found);
  state.SetLabel(s.where);
}

void describe(benchmark::State& state, bool upright) {
  const Scene& s = scene();
  Surf surf(config_for(static_cast<int>(state.range(0)), upright, 2), s.image.cols, s.image.rows);
  const auto points = surf.detect(bench::view(s.image));
  std::vector<SurfDescriptor> descriptors(points.size());
  for (auto _ : state) surf.describe(points, descriptors);
  state.counters["points"] = static_cast<double>(points.size());
}

void detect_and_describe(benchmark::State& state, bool upright) {
  const Scene& s = scene();
  Surf surf(config_for(static_cast<int>(state.range(0)), upright, 2), s.image.cols, s.image.rows);
  std::vector<SurfDescriptor> descriptors(static_cast<std::size_t>(state.range(0)));
  std::size_t found = 0;
  for (auto _ : state) {
    const auto points = surf.detect(bench::view(s.image));
    surf.describe(points, descriptors);
    found = points.size();
  }
  state.counters["points"] = static_cast<double>(found);
}

void match(benchmark::State& state) {
  const Scene& s = scene();
  Surf surf(config_for(static_cast<int>(state.range(0)), true, 2), s.image.cols, s.image.rows);
  const auto points = surf.detect(bench::view(s.image));
  std::vector<SurfDescriptor> descriptors(points.size());
  surf.describe(points, descriptors);
  SurfMatcher matcher({});
  for (auto _ : state) benchmark::DoNotOptimize(matcher.match(points, descriptors, points, descriptors, {}));
}

dlib::array2d<unsigned char> dlib_copy(const cv::Mat& image) {
  dlib::array2d<unsigned char> copy(image.rows, image.cols);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) copy[v][u] = image.at<unsigned char>(v, u);
  }
  return copy;
}

// dlib's get_surf_points in its own steps, with the threshold that leaves about the wanted number.
void dlib_oriented(benchmark::State& state) {
  const auto image = dlib_copy(scene().image);
  const long wanted = state.range(0);
  double threshold = 1;
  const auto points_at = [&](double t) { return static_cast<long>(dlib::get_surf_points(image, 100000, t).size()); };
  while (points_at(threshold) > wanted) threshold *= 1.05;
  std::size_t found = 0;
  for (auto _ : state) found = dlib::get_surf_points(image, wanted, threshold).size();
  state.counters["points"] = static_cast<double>(found);
}

void dlib_detect(benchmark::State& state) {
  const auto image = dlib_copy(scene().image);
  std::vector<dlib::interest_point> points;
  for (auto _ : state) {
    dlib::integral_image sums;
    sums.load(image);
    dlib::hessian_pyramid pyramid;
    pyramid.build_pyramid(sums, 4, 6, 2);
    dlib::get_interest_points(pyramid, 30.0, points);
  }
  state.counters["points"] = static_cast<double>(points.size());
}

void dlib_upright(benchmark::State& state) {
  const auto image = dlib_copy(scene().image);
  dlib::integral_image sums;
  sums.load(image);
  const auto points = dlib::get_surf_points(image, state.range(0), 1.0);
  for (auto _ : state) {
    dlib::matrix<double, 64, 1> descriptor;
    for (const auto& p : points) {
      dlib::compute_surf_descriptor(sums, p.p.center, p.p.scale, 0.0, descriptor);
      benchmark::DoNotOptimize(descriptor);
    }
  }
  state.counters["points"] = static_cast<double>(points.size());
}

}  // namespace

BENCHMARK(integral)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(detect, upright_step2, true, 2)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(detect, upright_step1, true, 1)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(detect, oriented_step2, false, 2)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(describe, upright, true)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(describe, oriented, false)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(detect_and_describe, upright, true)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(detect_and_describe, oriented, false)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(match)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(dlib_oriented)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(dlib_detect)->Unit(benchmark::kMillisecond);
BENCHMARK(dlib_upright)->Arg(1000)->Unit(benchmark::kMillisecond)->Name("dlib_describe_upright");
BENCHMARK_MAIN();
