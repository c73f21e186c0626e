// Our SURF beside dlib's in one run, one thread each: 752 x 480, both at the wanted number of described points. Both
// sample the first octave at every second pixel; 64 floats. Ours keeps the strongest above a low threshold, as the
// front end does; dlib's threshold is searched before the clock runs. Compare medians of CPU time of
//   surf_bench --benchmark_enable_random_interleaving=true --benchmark_repetitions=9
//   --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>
#include <dlib/image_keypoint.h>

#include <algorithm>
#include <cmath>
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
  for (auto _ : state) benchmark::DoNotOptimize(matcher.match(points, descriptors, points, descriptors, kAnywhere_px));
}

dlib::array2d<unsigned char> dlib_copy(const cv::Mat& image) {
  dlib::array2d<unsigned char> copy(image.rows, image.cols);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) copy[v][u] = image.at<unsigned char>(v, u);
  }
  return copy;
}

using DlibImage = dlib::array2d<unsigned char>;

// The threshold at which dlib detects and describes about `wanted` points: it drops those near the edge afterwards.
double dlib_threshold(const DlibImage& image, std::size_t wanted) {
  double low = 1e-3;
  double high = 1e3;
  for (int k = 0; k < 40; ++k) {
    const double middle = std::sqrt(low * high);
    (dlib::get_surf_points(image, 100000, middle).size() >= wanted ? low : high) = middle;
  }
  return low;
}

// What dlib::get_surf_points does, step by step, with orientation or without.
std::size_t dlib_surf(const DlibImage& image, double threshold, bool upright) {
  dlib::integral_image sums;
  sums.load(image);
  dlib::hessian_pyramid pyramid;
  pyramid.build_pyramid(sums, 4, 6, 2);
  std::vector<dlib::interest_point> points;
  dlib::get_interest_points(pyramid, threshold, points);
  std::size_t described = 0;
  const dlib::rectangle inside = dlib::get_rect(sums);
  for (const dlib::interest_point& p : points) {
    const auto side = static_cast<unsigned long>(32 * p.scale);
    if (!inside.contains(dlib::centered_rect(p.center, side, side))) continue;
    const double angle = upright ? 0.0 : dlib::compute_dominant_angle(sums, p.center, p.scale);
    dlib::matrix<double, 64, 1> descriptor;
    dlib::compute_surf_descriptor(sums, p.center, p.scale, angle, descriptor);
    benchmark::DoNotOptimize(descriptor);
    ++described;
  }
  return described;
}

void dlib_total(benchmark::State& state, bool upright) {
  const DlibImage image = dlib_copy(scene().image);
  const double threshold = dlib_threshold(image, static_cast<std::size_t>(state.range(0)));
  std::size_t found = 0;
  for (auto _ : state) found = dlib_surf(image, threshold, upright);
  state.counters["points"] = static_cast<double>(found);
}

void dlib_detect(benchmark::State& state) {
  const DlibImage image = dlib_copy(scene().image);
  const double threshold = dlib_threshold(image, static_cast<std::size_t>(state.range(0)));
  std::vector<dlib::interest_point> points;
  for (auto _ : state) {
    dlib::integral_image sums;
    sums.load(image);
    dlib::hessian_pyramid pyramid;
    pyramid.build_pyramid(sums, 4, 6, 2);
    dlib::get_interest_points(pyramid, threshold, points);
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
BENCHMARK(dlib_detect)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(dlib_total, upright, true)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(dlib_total, oriented, false)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
