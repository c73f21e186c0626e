#include "firmware-host/pelorus/eval/eval_run.h"

#include "firmware-host/pelorus/eval/eval_truth.h"

namespace pelorus {

Result<RunEvaluation> evaluate_run(const std::string& dataset, const std::string& calibration_file,
                                   const std::filesystem::path& folder, const EvaluationConfig& config) {
  const Result<EstimatedRun> run = read_run(folder);
  if (!run) return run.error();
  const Result<std::optional<StepTimes>> step_times = read_step_times(folder);
  if (!step_times) return step_times.error();
  const Result<std::optional<Truth>> truth = read_truth(dataset, calibration_file, run.value());
  if (!truth) return truth.error();

  RunEvaluation result;
  result.dataset = dataset;
  result.folder = folder.string();
  result.step_times = step_times.value();
  if (!truth.value()) {
    result.evaluation.facts = run_facts(run.value());
    return result;
  }
  result.has_truth = true;
  result.exact_truth = truth.value()->exact;
  result.scale_known = truth.value()->scale_known;
  result.truth_origin = truth.value()->origin;
  result.evaluation = evaluate(run.value(), *truth.value(), config);
  return result;
}

}  // namespace pelorus
