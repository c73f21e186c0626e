// What a step costs, whole and by stage, and how it grows with points, bodies and picture size. Each figure is the
// median of steps over rendered frames shown there and back again, on one thread, so that figures add up; with the
// helpers' threads a step is shorter (`pelorus bench latency`). --benchmark_filter=step/points and so on.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/base/nearest_rank.h"
#include "core/pipeline/pipeline.h"
#include "drivers/synthetic/synthetic_source.h"

namespace pelorus {
namespace {

constexpr int kRendered = 10;
constexpr int kWarmUp = 12;

struct View {
  int width_px = 1024;
  int height_px = 768;
  int bodies = 3;
  auto operator<=>(const View&) const = default;
};

// Boxes side by side over the seabed, each on a way of its own; as many as asked for fit into the view.
synthetic::Scene scene_of(const View& view) {
  synthetic::Scene scene;
  scene.frames = kRendered;
  scene.camera.width_px = view.width_px;
  scene.camera.height_px = view.height_px;
  scene.camera.f_px = 800.0 * view.width_px / 1024;
  scene.camera.look_down_rad = M_PI / 2;
  scene.vehicle.step_s = 1;
  scene.vehicle.p_sea = {{0, 0, 0}, {0.4, 0.05, 0.02}, {0.8, 0, 0}};
  scene.vehicle.rpy_rad = {{0, 0, 0}, {0.02, 0.01, 0.05}, {0, 0, 0.1}};
  const int columns = view.bodies > 4 ? 4 : std::max(1, view.bodies);
  const int rows = std::max(1, (view.bodies + columns - 1) / columns);
  const double size_m = view.bodies > 4 ? 0.36 : 0.55;
  for (int k = 0; k < view.bodies; ++k) {
    synthetic::Body body;
    body.name = "box" + std::to_string(k + 1);
    body.size_m = Eigen::Vector3d::Constant(size_m);
    const Eigen::Vector3d start(0.3 + 0.6 * (k / columns - 0.5 * (rows - 1)),
                                0.75 * (k % columns - 0.5 * (columns - 1)), 2.8);
    const double course = 2.4 * k;
    const Eigen::Vector3d way(0.25 * std::cos(course), 0.25 * std::sin(course), 0.05 * ((k % 3) - 1));
    body.path.step_s = 1;
    body.path.p_sea = {start, start + way, start + 2 * way};
    body.path.rpy_rad = {{0.2, 0.1, 0.3 * k}, {0.25, 0.15, 0.3 * k + 0.15}, {0.3, 0.2, 0.3 * k + 0.3}};
    scene.bodies.push_back(body);
  }
  scene.reseed(static_cast<std::uint64_t>(view.bodies + 1));
  return scene;
}

struct Dive {
  StereoRig rig;
  std::vector<SourcePair> pairs;
};

const Dive& dive_of(const View& view) {
  static std::map<View, Dive> known;
  Dive& dive = known[view];
  if (!dive.pairs.empty()) return dive;
  synthetic::SyntheticSource source(scene_of(view), 0);
  const CameraIntrinsics& camera = source.calibration().left;
  dive.rig = {camera.width, camera.height, camera.fx_px,
              camera.cx_px, camera.cy_px,  -source.calibration().T_right_left.translation().x()};
  for (SourcePair pair; source.next(pair).value(); pair = SourcePair{}) dive.pairs.push_back(std::move(pair));
  return dive;
}

double quantile_ms(std::vector<double>& values, double share) {
  std::sort(values.begin(), values.end());
  return nearest_rank(values, share);
}

void run_steps(benchmark::State& state, const View& view, int points) {
  const Dive& dive = dive_of(view);
  PipelineConfig config;
  config.front_end.max_points = points;
  Pipeline pipeline(config, dive.rig);
  std::vector<double> step_ms;
  std::array<std::vector<double>, kStageCount> stage_ms;
  double tracked = 0;
  double objects = 0;
  const std::size_t last = dive.pairs.size() - 1;
  std::uint64_t shown = 0;
  const auto step = [&]() -> const FrameResult& {
    const std::size_t place = shown % (2 * last);
    const SourcePair& pair = dive.pairs[place <= last ? place : 2 * last - place];
    const StereoFrame frame{shown, Timestamp{static_cast<std::int64_t>(shown) * 100'000'000}, pair.left.view(),
                            pair.right.view()};
    ++shown;
    return pipeline.step(frame);
  };
  for (int k = 0; k < kWarmUp; ++k) (void)step();
  for (auto _ : state) {
    const FrameResult& result = step();
    step_ms.push_back(1e-3 * result.report.step_microseconds);
    for (std::size_t s = 0; s < kStageCount; ++s) stage_ms[s].push_back(1e-3 * result.report.stages[s].microseconds);
    tracked += result.report.points_tracked;
    objects += result.objects_size;
  }
  const auto n = static_cast<double>(step_ms.size());
  state.counters["p50_ms"] = quantile_ms(step_ms, 0.5);
  state.counters["p99_ms"] = quantile_ms(step_ms, 0.99);
  for (std::size_t s = 0; s < kStageCount; ++s) {
    state.counters[to_text(static_cast<Stage>(s))] = quantile_ms(stage_ms[s], 0.5);
  }
  state.counters["tracked"] = tracked / n;
  state.counters["bodies_found"] = objects / n;
}

void points(benchmark::State& state) { run_steps(state, {}, static_cast<int>(state.range(0))); }
void bodies(benchmark::State& state) { run_steps(state, {1024, 768, static_cast<int>(state.range(0))}, 600); }
void size(benchmark::State& state) {
  run_steps(state, {static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), 3}, 600);
}

BENCHMARK(points)
    ->Name("step/points")
    ->Arg(200)
    ->Arg(400)
    ->Arg(600)
    ->Arg(750)
    ->Arg(1000)
    ->Arg(1500)
    ->Arg(2000)
    ->Iterations(150)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bodies)
    ->Name("step/bodies")
    ->Arg(0)
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->Arg(5)
    ->Arg(8)
    ->Arg(12)
    ->Arg(16)
    ->Iterations(150)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(size)
    ->Name("step/size")
    ->Args({640, 480})
    ->Args({752, 480})
    ->Args({1024, 768})
    ->Args({1280, 960})
    ->Args({1600, 1200})
    ->Iterations(150)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pelorus

BENCHMARK_MAIN();
