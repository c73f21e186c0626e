#include "firmware-host/pelorus/bench/bench.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "firmware-host/pelorus/bench/latency_picture.h"
#include "firmware-host/pelorus/bench/latency_report.h"
#include "firmware-host/pelorus/bench/latency_run.h"
#include "firmware-host/pelorus/picture_file.h"
#include "firmware-host/pelorus/progress_bar.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"
#include "firmware-host/runtime/config_loader.h"
#include "firmware-host/runtime/replay_source.h"

namespace pelorus {
namespace {

constexpr int kMissedExitCode = 1;
constexpr auto kHostLength = std::chrono::milliseconds(2000);
constexpr auto kHostPeriod = std::chrono::microseconds(1000);

struct LatencyArguments {
  std::string dataset;
  std::string calib;
  std::vector<std::string> configs;
  double rate_hz = 20;
  double seconds = 30;
  double latency_ms = 0;  // 0 = as configured
  int points = 0;         // 0 = as configured
  std::size_t frames = 60;
  bool normal = false;
  bool json = false;
  std::string picture;
};

Result<std::shared_ptr<const PreloadedPairs>> load_pairs(const LatencyArguments& arguments) {
  auto source = open_source(arguments.dataset, arguments.calib);
  if (!source) return source.error();
  return preload(*source.value(), arguments.frames);
}

Result<LatencyOptions> options_of(const LatencyArguments& arguments) {
  LatencyOptions options;
  if (const Result<Ok> applied = apply_config_files(arguments.configs, options.config); !applied)
    return applied.error();
  options.rate_hz = arguments.rate_hz;
  options.seconds = arguments.seconds;
  if (arguments.latency_ms > 0) options.config.timing.latency_ms = arguments.latency_ms;
  if (arguments.points > 0) options.config.pipeline.front_end.max_points = arguments.points;
  if (arguments.normal) options.config.process.realtime = options.config.process.lock_memory = false;
  return options;
}

Result<int> run_bench_latency(const LatencyArguments& arguments) {
  Result<LatencyOptions> options = options_of(arguments);
  if (!options) return options.error();
  if (!arguments.picture.empty()) {
    if (const Result<> usable = check_picture_name(arguments.picture); !usable) return usable.error();
  }
  const auto pairs = load_pairs(arguments);
  if (!pairs) return pairs.error();
  LatencyContext context{options.value(), arguments.dataset, pairs.value()->calibration.left.width,
                         pairs.value()->calibration.left.height, measure_wakeups(kHostLength, kHostPeriod)};
  ProgressBar bar("measuring", static_cast<std::size_t>(arguments.seconds + 0.5), "seconds");
  context.options.progress = [&](double share) { bar.update(static_cast<std::size_t>(share * arguments.seconds)); };
  const ReplayInterrupt interrupt;
  context.options.stop = [] { return ReplayInterrupt::requested(); };
  const Result<LatencyRun> run = run_latency(pairs.value(), context.options);
  bar.clear();
  if (!run) return run.error();
  const std::string text =
      arguments.json ? latency_json(context, run.value()) + "\n" : latency_table(context, run.value());
  std::fputs(text.c_str(), stdout);
  if (!arguments.picture.empty()) {
    if (const Result<> written = write_latency_picture(arguments.picture, context, run.value()); !written) {
      return written.error();
    }
  }
  if (run.value().interrupted) return kInterruptedExitCode;
  const auto& steps = run.value().steps;
  const bool missed = std::any_of(steps.begin(), steps.end(), [](const ReleasedStep& s) { return s.deadline_missed; });
  return missed ? kMissedExitCode : 0;
}

}  // namespace

Verb add_bench(CLI::App& app) {
  auto arguments = std::make_shared<LatencyArguments>();
  CLI::App* parser = app.add_subcommand("bench", "Measure the service on this computer");
  parser->require_subcommand(1);
  CLI::App* latency = parser->add_subcommand(
      "latency", "The service's threads on recorded pairs at a given rate: time of every stage, latency, misses");
  latency->add_option("dataset", arguments->dataset, kDatasetHelp)->required()->option_text("DATASET REQUIRED");
  latency->add_option("--rate", arguments->rate_hz, "Pairs per second")->check(above_zero())->capture_default_str();
  latency->add_option("--seconds", arguments->seconds, "Time counted, after 2 s of warm-up")
      ->check(above_zero())
      ->capture_default_str();
  latency->add_option("--frames", arguments->frames, "Pairs held in memory and shown there and back again")
      ->check(CLI::Range(3, 10000))
      ->capture_default_str();
  latency->add_option("--points", arguments->points, "Points of the front end (default: as configured, 750)")
      ->check(CLI::Range(50, 2000));
  latency->add_option("--latency-ms", arguments->latency_ms, "Declared latency (default: as configured)")
      ->check(above_zero());
  latency->add_option("--calib", arguments->calib, "Calibration in place of the recording's own");
  latency->add_option("--config", arguments->configs, "Settings file of the service; several apply in turn")
      ->allow_extra_args(false);
  latency->add_flag("--normal", arguments->normal, "Ask for no real-time scheduling and no locked memory");
  latency->add_flag("--json", arguments->json, "One JSON object in place of the table");
  latency->add_option("--picture", arguments->picture, "Histograms as PNG");
  latency->footer(
      "Example: pelorus bench latency out/paper --rate 30 --seconds 600 --picture latency.png\n"
      "Exit codes: 0 no deadline missed, 1 some missed, 2 usage, 3 input, 4 calibration, 5 configuration,\n"
      "6 input/output,\n130 interrupted (what was measured until then is printed).");
  return {parser, [arguments] { return run_bench_latency(*arguments); }};
}

}  // namespace pelorus
