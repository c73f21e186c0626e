#include "firmware-host/pelorus/eval/ablate.h"

#include <stdlib.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "firmware-host/pelorus/eval/ablate_table.h"
#include "firmware-host/pelorus/progress_bar.h"
#include "firmware-host/pelorus/replay/replay_dive.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"
#include "firmware-host/pelorus/replay/replay_run.h"
#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/runtime/config_fields.h"
#include "firmware-host/runtime/config_loader.h"
#include "firmware-host/runtime/replay_source.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

struct AblateArguments {
  std::string dataset;
  std::string out;
  std::string calibration;
  std::vector<std::string> configs;
  std::vector<std::string> only;
  std::uint64_t frames = 0;
  bool overwrite = false;
  bool json = false;
};

constexpr const char* kAllOn = "all_on";  // the folder of the run with all steps

// Where runs go: the user's folder, or one of our own that disappears.
class WorkFolder {
 public:
  [[nodiscard]] static Result<WorkFolder> create(const std::string& wanted, bool overwrite) {
    WorkFolder folder;
    if (!wanted.empty()) {
      if (Result<> usable = make_usable(wanted, overwrite); !usable) return usable.error();
      folder.path_ = wanted;
      return folder;
    }
    std::error_code error;
    std::string pattern = (fs::temp_directory_path(error) / "pelorus_ablate_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) {
      return Error{ErrorCode::io, pattern, "no temporary folder can be made", "give --out"};
    }
    folder.path_ = pattern;
    folder.temporary_ = true;
    return folder;
  }
  WorkFolder(WorkFolder&& other) noexcept : path_(std::move(other.path_)), temporary_(other.temporary_) {
    other.temporary_ = false;
  }
  WorkFolder& operator=(WorkFolder&&) = delete;
  ~WorkFolder() {
    std::error_code ignored;
    if (temporary_) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  WorkFolder() = default;
  // Before the dive is rendered, which a demo does under the same name: one that is killed there is known too.
  static Result<> mark_as_own(const fs::path& folder) {
    std::error_code error;
    fs::create_directory(folder / kAllOn, error);
    if (!error) return Ok{};
    return Error{ErrorCode::io, folder.string(), "cannot create a folder in it: " + error.message(),
                 "check its rights and free space"};
  }
  // An earlier ablation is replaced when asked for; anything else in the folder is not ours to touch.
  static Result<> make_usable(const fs::path& folder, bool overwrite) {
    std::error_code error;
    if (overwrite && fs::is_directory(folder / kAllOn, error)) return Ok{};
    Result<Ok> ready = prepare_output_folder(folder, false);
    if (ready) return mark_as_own(folder);
    const bool holds_something = fs::is_directory(folder, error) && !fs::is_empty(folder, error) && !error;
    if (!overwrite || !holds_something) return ready;
    return Error{ErrorCode::io, folder.string(), "the folder holds something else than an earlier ablation",
                 "give --out another folder"};
  }
  fs::path path_;
  bool temporary_ = false;
};

std::vector<std::string> step_names() {
  PipelineConfig config;
  std::vector<std::string> names;
  for (const ConfigField& field : config_fields(config)) {
    if (field.section == "steps" && std::holds_alternative<bool*>(field.value)) names.emplace_back(field.key);
  }
  return names;
}

void switch_off(const std::string& step, PipelineConfig& config) {
  for (const ConfigField& field : config_fields(config)) {
    if (field.section == "steps" && field.key == step) *std::get<bool*>(field.value) = false;
  }
}

Result<RunEvaluation> replay_and_evaluate(const std::string& dataset, const AblateArguments& arguments,
                                          const PipelineConfig& config, const fs::path& folder,
                                          const std::string& title, AblationRun& run) {
  Result<std::unique_ptr<StereoSource>> source = open_source(dataset, arguments.calibration);
  if (!source) return source.error();
  if (Result<Ok> ready = prepare_output_folder(folder, arguments.overwrite); !ready) return ready.error();
  ReplayOptions options;
  options.pipeline = config;
  options.out_folder = folder;
  options.max_frames = arguments.frames;
  options.stop = ReplayInterrupt::requested;
  const std::size_t all = source.value()->pair_count();
  ProgressBar bar(title, arguments.frames > 0 ? std::min(all, static_cast<std::size_t>(arguments.frames)) : all,
                  "pairs");
  options.progress = [&bar](std::uint64_t done, std::uint64_t) { bar.update(done); };
  options.warn = [&bar](const Error& error) { bar.tell(skipped_text(error)); };
  const Result<ReplaySummary> summary = run_replay(*source.value(), options);
  if (!summary) return summary.error();
  run.broke_off = summary.value().broke_off;
  if (summary.value().ended_early) return *summary.value().failure;
  if (is_incomplete(summary.value())) run.incomplete = incomplete_text(summary.value());
  return evaluate_run(dataset, arguments.calibration, folder, {});
}

// All on, then one off at a time; ends early when interrupted.
std::vector<AblationRun> run_all(const std::string& dataset, const AblateArguments& arguments,
                                 const PipelineConfig& config, const std::vector<std::string>& steps,
                                 const fs::path& folder) {
  std::vector<AblationRun> runs;
  for (std::size_t i = 0; i <= steps.size(); ++i) {
    AblationRun run;
    run.step_off = i == 0 ? "" : steps[i - 1];
    PipelineConfig changed = config;
    switch_off(run.step_off, changed);
    const std::string name = i == 0 ? kAllOn : "without_" + run.step_off;
    const std::string title = name + " (" + std::to_string(i + 1) + "/" + std::to_string(steps.size() + 1) + ")";
    Result<RunEvaluation> result = replay_and_evaluate(dataset, arguments, changed, folder / name, title, run);
    if (ReplayInterrupt::requested()) break;
    if (result) {
      run.result = std::move(result.value());
    } else {
      run.failure = result.error().message();
      run.failure_code = result.error().code;
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

Result<std::vector<std::string>> chosen_steps(const AblateArguments& arguments) {
  const std::vector<std::string> all = step_names();
  if (arguments.only.empty()) return all;
  for (const std::string& step : arguments.only) {
    if (std::find(all.begin(), all.end(), step) != all.end()) continue;
    std::string names;
    for (const std::string& name : all) names += (names.empty() ? "" : ", ") + name;
    return Error{ErrorCode::bad_usage, "--only", "'" + step + "' is no step of the method", "steps: " + names};
  }
  return arguments.only;
}

Result<int> run_verb(const AblateArguments& arguments) {
  PipelineConfig config;
  if (const Result<Ok> applied = apply_config_files(arguments.configs, config); !applied) return applied.error();
  const Result<std::vector<std::string>> steps = chosen_steps(arguments);
  if (!steps) return steps.error();
  if (Result<> usable = check_recording(arguments.dataset, arguments.calibration); !usable) return usable.error();
  const Result<WorkFolder> folder = WorkFolder::create(arguments.out, arguments.overwrite);
  if (!folder) return folder.error();
  const ReplayInterrupt interrupt;
  std::string dataset = arguments.dataset;
  if (is_scene(dataset)) {
    const fs::path rendered = folder.value().path() / "dataset";
    const Result<bool> done = render_dive(dataset, arguments.frames, rendered);
    if (!done) return done.error();
    if (!done.value()) return kInterruptedExitCode;
    dataset = rendered.string();
  }
  const std::vector<AblationRun> runs = run_all(dataset, arguments, config, steps.value(), folder.value().path());
  std::fputs((arguments.json ? to_json(runs) + "\n" : to_table(runs)).c_str(), stdout);
  const bool kept = !arguments.out.empty() && !runs.empty() && runs.front().result;
  if (kept && !arguments.json) std::printf("runs  %s\n", arguments.out.c_str());
  if (ReplayInterrupt::requested()) return kInterruptedExitCode;
  if (runs.front().broke_off) {
    std::fprintf(stderr, "pelorus: the recording broke off: %s\n", runs.front().failure.c_str());
    return kBrokeOffExitCode;
  }
  if (!runs.front().result) {
    return Error{runs.front().failure_code, arguments.dataset, "the run with all steps failed: " + runs.front().failure,
                 ""};
  }
  if (!runs.front().result->has_truth) {
    return Error{ErrorCode::bad_input, arguments.dataset, "the data set holds no truth to compare with", ""};
  }
  if (runs.front().incomplete.empty()) return 0;
  std::fprintf(stderr, "%s\n", runs.front().incomplete.c_str());
  return exit_code(ErrorCode::bad_input);
}

}  // namespace

Verb add_ablate(CLI::App& app) {
  auto arguments = std::make_shared<AblateArguments>();
  CLI::App* parser = app.add_subcommand("ablate", "What each step of the method is worth: one left out at a time");
  parser->add_option("DATASET", arguments->dataset, "Data set with truth. " + std::string(kDatasetHelp))->required();
  parser->add_option("--out", arguments->out, "Keep the runs here, one folder each (default: removed at the end)");
  parser->add_option("--calib", arguments->calibration, "Calibration file instead of the data set's own");
  parser->add_option("--config", arguments->configs, "Settings file; several apply in turn")->allow_extra_args(false);
  parser->add_option("--only", arguments->only, "Steps to leave out, separated by commas (default: each)")
      ->delimiter(',');
  parser->add_option("--frames", arguments->frames, "Take the first N pairs only")->check(count_above_zero());
  parser->add_flag("--overwrite", arguments->overwrite, "Replace the runs of an earlier ablation in OUT");
  parser->add_flag("--json", arguments->json, "JSON instead of a table: SI units, radians");
  parser->footer(
      "Exit codes: 0 done, 2 usage, 3 bad input or no truth, 4 calibration, 5 configuration, 6 output, 8 the "
      "recording\n"
      "broke off, 130 interrupted.\n"
      "Missing and damaged pairs are told of; the exit code is 3 then, also for a single one.");
  return {parser, [arguments] { return run_verb(*arguments); }};
}

}  // namespace pelorus
