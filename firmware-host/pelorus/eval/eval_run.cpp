#include "firmware-host/pelorus/eval/eval_run.h"

#include "firmware-host/pelorus/eval/eval_truth.h"
#include "firmware-host/pelorus/eval/truth_doubt.h"
#include "firmware-host/pelorus/results/incomplete_mark.h"

namespace pelorus {

Result<JudgedRun> judge_run(const std::string& dataset, const std::string& calibration_file,
                            const std::filesystem::path& folder, const EvaluationConfig& config) {
  JudgedRun judged;
  Result<EstimatedRun> run = read_run(folder, &judged.cut);
  if (!run) return run.error();
  judged.run = std::move(run.value());
  const Result<std::optional<StepTimes>> step_times = read_step_times(folder);
  if (!step_times) return step_times.error();
  const Result<std::optional<LostPairs>> lost = read_lost_pairs(folder);
  if (!lost) return lost.error();
  if (!dataset.empty()) {
    Result<std::optional<Truth>> truth = read_truth(dataset, calibration_file, judged.run);
    if (!truth) return truth.error();
    judged.truth = std::move(truth.value());
    const Result<Goals> goals = goals_of(dataset);
    if (!goals) return goals.error();
    judged.evaluation.goals = goals.value();
  }

  RunEvaluation& result = judged.evaluation;
  result.dataset = dataset;
  result.folder = folder.string();
  result.step_times = step_times.value();
  result.lost = lost.value();
  result.incomplete = incomplete_reason(folder);
  if (result.incomplete && !judged.cut.empty()) *result.incomplete += "; " + judged.cut;
  if (!judged.truth) {
    result.evaluation.facts = run_facts(judged.run);
    return judged;
  }
  result.has_truth = true;
  result.exact_truth = judged.truth->exact;
  result.scale_known = judged.truth->scale_known;
  result.truth_origin = judged.truth->origin;
  result.evaluation = evaluate(judged.run, *judged.truth, config);
  result.doubt = truth_doubt(result.evaluation);
  return judged;
}

Result<RunEvaluation> evaluate_run(const std::string& dataset, const std::string& calibration_file,
                                   const std::filesystem::path& folder, const EvaluationConfig& config) {
  Result<JudgedRun> judged = judge_run(dataset, calibration_file, folder, config);
  if (!judged) return judged.error();
  return std::move(judged.value().evaluation);
}

}  // namespace pelorus
