#include "firmware-host/pelorus/report/report.h"

#include <cstdio>
#include <memory>

#include "firmware-host/pelorus/eval/truth_doubt.h"
#include "firmware-host/pelorus/report/page.h"
#include "firmware-host/pelorus/results/incomplete_mark.h"
#include "firmware-host/pelorus/results/result_files.h"

namespace pelorus {
namespace {

struct ReportArguments {
  std::string out;
  std::string dataset;
  std::string calibration;
  std::string file;
};

Result<int> run_verb(const ReportArguments& arguments) {
  std::filesystem::path file = arguments.file;
  std::fputs(incomplete_warning(arguments.out).c_str(), stderr);
  if (file.empty()) file = ResultPaths(arguments.out).report;
  const Result<std::optional<std::string>> written =
      write_report(arguments.out, arguments.dataset, arguments.calibration, file);
  if (!written) return written.error();
  if (written.value()) std::fprintf(stderr, "pelorus: warning: %s\n", written.value()->c_str());
  std::printf("report   %s\n", file.c_str());
  return done_exit_code(arguments.out);
}

// Truth of other times would leave a page that looks like one without truth.
Error no_common_time(const std::string& dataset) {
  return {ErrorCode::bad_input, dataset, "no frame of the run has truth of the same time",
          "name the data set the run was made from, or leave DATASET out for a page without truth"};
}

}  // namespace

Result<std::optional<std::string>> write_report(const std::filesystem::path& folder, const std::string& dataset,
                                                const std::string& calibration_file,
                                                const std::filesystem::path& file) {
  const EvaluationConfig config;
  ReportInput input;
  Result<JudgedRun> judged = judge_run(dataset, calibration_file, folder, config);
  if (!judged) return judged.error();
  input.judged = std::move(judged.value());
  if (input.judged.truth && !input.judged.run.empty() && frames_with_truth(*input.judged.truth) == 0)
    return no_common_time(dataset);
  if (input.judged.truth) input.errors = error_series(input.judged.run, *input.judged.truth, config.association);
  Result<std::vector<ScenePoint>> points = read_points(folder);
  if (!points) return points.error();
  input.points = std::move(points.value());
  Result<std::vector<SceneOutline>> outlines = read_outlines(folder);
  if (!outlines) return outlines.error();
  input.outlines = std::move(outlines.value());
  Result<StageRecord> stages = read_stages(folder);
  if (!stages) return stages.error();
  input.stages = std::move(stages.value());
  input.thumbnails = thumbnails(ResultPaths(folder).overlay, PageBudget().pictures);
  if (const Result<Ok> written = write_page(file, input); !written) return written.error();
  return input.judged.evaluation.doubt;
}

Verb add_report(CLI::App& app) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* parser = app.add_subcommand("report", "One HTML page of a run: replay in 3D, errors, states, latencies");
  parser->add_option("OUT", arguments->out, "The output folder of `pelorus replay`")->required();
  parser->add_option("DATASET", arguments->dataset,
                     "The data set the run was made from: adds the errors against truth");
  parser->add_option("--calib", arguments->calibration, "The calibration file given to replay, if one was");
  parser->add_option("--file", arguments->file, "The page's name (default: OUT/report.html); replaced when it exists");
  parser->footer(
      "Exit codes: 0 written, 2 usage, 3 bad input, or written from an INCOMPLETE run, 4 calibration, 6 output.");
  return {parser, [arguments] { return run_verb(*arguments); }};
}

}  // namespace pelorus
