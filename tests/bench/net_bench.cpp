// Cost of the net of static points and of point in hull: both run once or more per frame (paper 5.2.2 to 5.2.4).

#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "core/geometry/delaunay.h"
#include "core/geometry/hull.h"

namespace pelorus {
namespace {

std::vector<Eigen::Vector2d> image_points(int count) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(0, 1024);
  std::uniform_real_distribution<double> v(0, 768);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(u(rng), v(rng));
  return points;
}

void triangulate(benchmark::State& state) {
  const auto points = image_points(static_cast<int>(state.range(0)));
  Delaunay net(static_cast<int>(points.size()));
  for (auto _ : state) benchmark::DoNotOptimize(net.run(points));
}
BENCHMARK(triangulate)->Arg(150)->Arg(600)->Arg(2000)->Unit(benchmark::kMicrosecond);

void find_triangle(benchmark::State& state) {
  const auto points = image_points(600);
  Delaunay net(600);
  const bool has_net = net.run(points);
  std::size_t i = 0;
  for (auto _ : state) {
    i = (i + 1) % points.size();
    benchmark::DoNotOptimize(has_net && net.find(points[i] + Eigen::Vector2d(0.5, 0.5)) >= 0);
  }
}
BENCHMARK(find_triangle);

void point_in_hull(benchmark::State& state) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto draw = [&](double scale) {
    return Eigen::Vector3d(scale * uniform(rng), scale * uniform(rng), scale * uniform(rng));
  };
  std::vector<Eigen::Vector3d> cloud;
  for (int i = 0; i < state.range(0); ++i) cloud.push_back(draw(1));
  std::vector<Eigen::Vector3d> asked;
  for (int i = 0; i < 256; ++i) asked.push_back(draw(1.5));
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(distance_to_hull(cloud, asked[i++ % asked.size()]));
}
BENCHMARK(point_in_hull)->Arg(40)->Arg(150);

}  // namespace
}  // namespace pelorus
