#include "firmware-host/pelorus/replay/replay.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "firmware-host/pelorus/progress_bar.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"
#include "firmware-host/pelorus/replay/replay_run.h"
#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/runtime/config_loader.h"
#include "firmware-host/runtime/replay_source.h"

namespace pelorus {
namespace {

struct ReplayArguments {
  std::string dataset;
  std::string out;
  std::string calibration;
  std::vector<std::string> configs;
  std::uint64_t frames = 0;
  bool overlay = false;
  int overlay_every = 0;  // 0: not given
  bool realtime = false;
  bool stepped = false;
  bool overwrite = false;
};

Result<int> run_verb(const ReplayArguments& arguments) {
  ReplayOptions options;
  if (const Result<Ok> applied = apply_config_files(arguments.configs, options.pipeline); !applied)
    return applied.error();
  // The source first: a mistyped data set must not leave an output folder behind.
  Result<std::unique_ptr<StereoSource>> source = open_source(arguments.dataset, arguments.calibration);
  if (!source) return source.error();
  if (auto sides = check_recording(arguments.dataset, arguments.calibration); !sides) return sides.error();
  std::fprintf(stderr, "%s\n", source.value()->description().c_str());
  if (Result<Ok> ready = prepare_output_folder(arguments.out, arguments.overwrite); !ready) return ready.error();

  options.out_folder = arguments.out;
  options.max_frames = arguments.frames;
  options.realtime = arguments.realtime;
  options.overlay_every = arguments.overlay_every > 0 ? arguments.overlay_every : arguments.overlay ? 1 : 0;
  options.stop = ReplayInterrupt::requested;
  const ReplayInterrupt interrupt;
  const std::size_t all = source.value()->pair_count();
  ProgressBar bar("replaying", arguments.frames > 0 ? std::min(all, static_cast<std::size_t>(arguments.frames)) : all,
                  "pairs");
  options.progress = [&bar](std::uint64_t done, std::uint64_t) { bar.update(done); };
  options.warn = [&bar](const Error& error) { bar.tell(skipped_text(error)); };
  Result<ReplaySummary> summary = run_replay(*source.value(), options);
  bar.clear();
  if (!summary) return summary.error();
  std::printf("%sresults  %s\n", to_text(summary.value()).c_str(), arguments.out.c_str());
  std::fflush(stdout);  // before what follows on stderr, also when both go to one file
  if (summary.value().broke_off) {
    std::fprintf(stderr, "pelorus: the recording broke off, what was processed before is good: %s\n",
                 summary.value().failure->message().c_str());
    return kBrokeOffExitCode;
  }
  if (summary.value().ended_early) return *summary.value().failure;
  if (summary.value().interrupted) {
    std::fprintf(stderr, "pelorus: interrupted; the files hold every frame up to here\n");
    return kInterruptedExitCode;
  }
  if (!is_incomplete(summary.value())) return 0;
  std::fprintf(stderr, "%s\n", incomplete_text(summary.value()).c_str());
  return exit_code(ErrorCode::bad_input);
}

}  // namespace

Verb add_replay(CLI::App& app) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* parser = app.add_subcommand("replay", "Recorded frames through the pipeline into result files");
  parser->add_option("DATASET", arguments->dataset, kDatasetHelp)->required();
  parser
      ->add_option(
          "--out", arguments->out,
          "Output folder: camera.tum, objects.csv, frames.csv, timing.csv, points.csv, outlines.csv, lost_pairs.csv")
      ->required();
  parser->add_option("--calib", arguments->calibration, "Calibration file instead of the data set's own");
  parser->add_option("--config", arguments->configs, "Settings file (config/pelorus.yaml); several apply in turn")
      ->allow_extra_args(false);
  parser->add_option("--frames", arguments->frames, "Take the first N pairs only")->check(count_above_zero());
  parser->add_flag("--overlay", arguments->overlay, "Write an annotated picture of each frame to OUT/overlay");
  parser->add_option("--overlay-every", arguments->overlay_every, "Only of every N-th frame (implies --overlay)")
      ->check(count_above_zero());
  CLI::Option* realtime =
      parser->add_flag("--realtime", arguments->realtime, "Feed at the recorded times; when late the newest pair wins");
  parser->add_flag("--stepped", arguments->stepped, "Every pair, as fast as possible (default)")->excludes(realtime);
  parser->add_flag("--overwrite", arguments->overwrite, "Replace the results of an earlier run in OUT");
  parser->footer(
      "Exit codes: 0 done, 2 usage, 3 bad input, or done without pairs that the recording lacks or that are damaged,\n"
      "4 calibration, 5 configuration, 6 output, 8 the recording broke off, 130 interrupted.\n"
      "Missing and damaged pairs are told of, and the run goes on; a single one makes the exit code 3. Four damaged\n"
      "pairs in a row are the end (8), but not before the first good one: these are skipped, however many. Until a run "
      "has come to its end its folder holds a file\n"
      "INCOMPLETE with the reason; what was processed before an error is kept.");
  return {parser, [arguments] { return run_verb(*arguments); }};
}

}  // namespace pelorus
