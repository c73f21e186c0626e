// Rectification of a pair's image by our table beside cv::remap with fixed-point maps, in one run, one thread each:
// 752 x 480 with the distortion of EuRoC's cameras, and 1600 x 1200.

#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>

#include "core/geometry/remap_table.h"
#include "tests/bench/test_images.h"

namespace {

using namespace pelorus;

// Radial distortion about the middle.
Eigen::Vector2d raw_place(int u, int v, const cv::Size& size) {
  const double f = 0.61 * size.width;
  const double x = (u - 0.5 * size.width) / f;
  const double y = (v - 0.5 * size.height) / f;
  const double r2 = x * x + y * y;
  const double d = 1 - 0.283 * r2 + 0.074 * r2 * r2;
  return {f * x * d + 0.5 * size.width, f * y * d + 0.5 * size.height};
}

void ours(benchmark::State& state) {
  const cv::Size size(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const cv::Mat raw = bench::rendered(size.width, size.height);
  RemapTable table(size.width, size.height, size.width, size.height);
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) table.set(u, v, raw_place(u, v, size));
  table.finish();
  Image out;
  for (auto _ : state) table.apply(bench::view(raw), out);
}

void opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Size size(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const cv::Mat raw = bench::rendered(size.width, size.height);
  cv::Mat map(size, CV_32FC2);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const Eigen::Vector2d p = raw_place(u, v, size);
      map.at<cv::Vec2f>(v, u) = {static_cast<float>(p.x()), static_cast<float>(p.y())};
    }
  }
  cv::Mat whole, part, out;
  cv::convertMaps(map, cv::noArray(), whole, part, CV_16SC2);
  for (auto _ : state) cv::remap(raw, out, whole, part, cv::INTER_LINEAR);
}

}  // namespace

BENCHMARK(ours)->Args({752, 480})->Args({1600, 1200})->Unit(benchmark::kMillisecond);
BENCHMARK(opencv)->Args({752, 480})->Args({1600, 1200})->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
