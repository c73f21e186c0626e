#include "firmware-host/pelorus/demo.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "drivers/synthetic/scene_file.h"
#include "firmware-host/pelorus/eval/eval_table.h"
#include "firmware-host/pelorus/progress_bar.h"
#include "firmware-host/pelorus/replay/replay_dive.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"
#include "firmware-host/pelorus/replay/replay_run.h"
#include "firmware-host/pelorus/report/page.h"
#include "firmware-host/pelorus/report/report.h"
#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/runtime/replay_source.h"
#include "firmware-host/runtime/scene_lookup.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

constexpr int kOverlayEvery = 10;

struct DemoArguments {
  std::string out = "out/demo";
  std::string scene = "paper";
  std::uint64_t frames = 0;
};

// An earlier demo is replaced; anything else in the folder is not ours to touch.
Result<Ok> check_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    return Error{ErrorCode::io, folder.string(), "the output is a file, not a folder", "give --out a folder"};
  }
  const bool foreign = fs::is_directory(folder, error) && !fs::is_empty(folder, error) &&
                       !fs::exists(folder / "dataset", error) && !fs::exists(folder / "results", error) &&
                       !fs::exists(folder / "dataset.partial", error);  // of a demo that was killed
  if (foreign) {
    return Error{ErrorCode::io, folder.string(), "the folder holds something else than an earlier demo",
                 "give --out another folder"};
  }
  fs::create_directories(folder, error);
  if (error) return Error{ErrorCode::io, folder.string(), "cannot create: " + error.message(), "check path and rights"};
  return Ok{};
}

Result<ReplaySummary> replay_dive(const fs::path& dataset, const fs::path& results) {
  Result<std::unique_ptr<StereoSource>> source = open_source(dataset.string(), "");
  if (!source) return source.error();
  if (Result<Ok> ready = prepare_output_folder(results, true); !ready) return ready.error();
  ReplayOptions options;
  options.out_folder = results;
  options.overlay_every = kOverlayEvery;
  options.stop = ReplayInterrupt::requested;
  ProgressBar bar("processing", source.value()->pair_count(), "pairs");
  options.progress = [&bar](std::uint64_t done, std::uint64_t) { bar.update(done); };
  options.warn = [&bar](const Error& error) { bar.tell(skipped_text(error)); };
  return run_replay(*source.value(), options);
}

Result<int> run_verb(const DemoArguments& arguments) {
  const fs::path folder(arguments.out);
  const fs::path dataset = folder / "dataset";
  const fs::path results = folder / "results";
  // The scene first: one that cannot be read must not leave a folder behind.
  const Result<std::string> scene = find_scene(arguments.scene);
  if (!scene) return scene.error();
  if (const auto loaded = synthetic::load_scene(scene.value()); !loaded) return loaded.error();
  if (Result<Ok> checked = check_folder(folder); !checked) return checked.error();
  const ReplayInterrupt interrupt;
  std::printf("Rendering the scene '%s': a stereo dive with exact truth ...\n", arguments.scene.c_str());
  std::fflush(stdout);
  const Result<bool> rendered = render_dive(arguments.scene, arguments.frames, dataset);
  if (!rendered) return rendered.error();
  if (!rendered.value()) {
    std::fprintf(stderr, "pelorus: interrupted while rendering\n");
    return kInterruptedExitCode;
  }
  std::printf("Processing it, without masks and without any knowledge of the scene ...\n\n");
  std::fflush(stdout);
  const Result<ReplaySummary> summary = replay_dive(dataset, results);
  if (!summary) return summary.error();
  if (summary.value().failure) return *summary.value().failure;
  if (summary.value().interrupted) {
    std::fprintf(stderr, "pelorus: interrupted; the files in %s hold every frame up to here\n", results.c_str());
    return kInterruptedExitCode;
  }
  const Result<RunEvaluation> run = evaluate_run(dataset.string(), "", results, {});
  if (!run) return run.error();
  std::printf("%s\n", to_table(run.value()).c_str());
  std::printf("Pictures    %s\n", (results / "overlay").c_str());
  std::printf("Trajectory  %s, objects %s\n", ResultPaths(results).camera.c_str(),
              ResultPaths(results).objects.c_str());
  std::printf("Images      %s (EuRoC layout, with truth)\n", dataset.c_str());
  if (page_template().empty()) return 0;  // built without the page
  const fs::path report = ResultPaths(results).report;
  const auto written = write_report(results, dataset.string(), "", report);
  if (!written) return written.error();
  std::printf("Report      %s (open it in a browser)\n", report.c_str());
  return 0;
}

}  // namespace

Verb add_demo(CLI::App& app) {
  auto arguments = std::make_shared<DemoArguments>();
  CLI::App* parser = app.add_subcommand("demo", "The paper's experiment: render it, process it, print the errors");
  parser->add_option("--out", arguments->out, "Folder for images, results and pictures; an earlier demo is replaced")
      ->capture_default_str();
  parser->add_option("--scene", arguments->scene, "Another shipped scene or scene file")->capture_default_str();
  parser->add_option("--frames", arguments->frames, "Render the first N frames only")->check(count_above_zero());
  parser->footer("Exit codes: 0 done, 2 usage, 3 bad input, 4 calibration, 5 scene file, 6 output, 130 interrupted.");
  return {parser, [arguments] { return run_verb(*arguments); }};
}

}  // namespace pelorus
