#include "firmware-host/pelorus/eval/eval.h"

#include <cstdio>
#include <memory>
#include <string>

#include "firmware-host/pelorus/eval/eval_json.h"
#include "firmware-host/pelorus/eval/eval_run.h"
#include "firmware-host/pelorus/eval/eval_table.h"
#include "firmware-host/pelorus/results/incomplete_mark.h"

namespace pelorus {
namespace {

struct EvalArguments {
  std::string dataset;
  std::string out;
  std::string calibration;
  std::string goals;
  bool json = false;
  EvaluationConfig config;
};

Result<int> run_verb(const EvalArguments& arguments) {
  Result<RunEvaluation> run = evaluate_run(arguments.dataset, arguments.calibration, arguments.out, arguments.config);
  std::fputs(incomplete_warning(arguments.out).c_str(), stderr);
  if (!run) return run.error();
  if (!arguments.goals.empty()) {
    const Result<Goals> goals = synthetic::load_goals(arguments.goals);
    if (!goals) return goals.error();
    run.value().goals = goals.value();
  }
  const std::string text = arguments.json ? to_json(run.value()) + "\n" : to_table(run.value());
  std::fputs(text.c_str(), stdout);
  if (run.value().doubt) std::fprintf(stderr, "pelorus: warning: %s\n", run.value().doubt->c_str());
  if (!run.value().has_truth) {
    return Error{ErrorCode::bad_input, arguments.dataset,
                 "the data set holds no truth: only the run's own facts are shown",
                 "EuRoC: mav0/state_groundtruth_estimate0/data.csv; KITTI: poses.txt or poses_cam0_from_oxts.txt"};
  }
  if (!run.value().evaluation.camera) {
    return Error{ErrorCode::bad_input, arguments.out, "fewer than two poses have truth of the same time",
                 "check that the run is one of this data set"};
  }
  return done_exit_code(arguments.out);
}

}  // namespace

Verb add_eval(CLI::App& app) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* parser = app.add_subcommand("eval", "Error tables of a run against the truth of its data set");
  parser->add_option("DATASET", arguments->dataset, "The data set the run was made from")->required();
  parser->add_option("OUT", arguments->out, "The output folder of `pelorus replay`")->required();
  parser->add_option("--calib", arguments->calibration, "The calibration file given to replay, if one was");
  parser->add_option("--goals", arguments->goals,
                     "File with goals in place of the data set's own (its scene's, mav0/goals.yaml, goals.yaml)");
  parser->add_flag("--json", arguments->json, "JSON instead of a table: SI units, radians");
  parser
      ->add_option("--gate-m", arguments->config.association.centre_gate_m,
                   "How far an object's points may lie from a body's centre to be that body")
      ->check(above_zero())
      ->capture_default_str();
  parser->footer(
      "Exit codes: 0 evaluated, 2 usage, 3 bad input or no truth, or the run is INCOMPLETE, 4 calibration, 5 goals,\n"
      "6 a file cannot be read.\n"
      "Goals that are met or missed show in the table; they do not change the exit code.");
  return {parser, [arguments] { return run_verb(*arguments); }};
}

}  // namespace pelorus
