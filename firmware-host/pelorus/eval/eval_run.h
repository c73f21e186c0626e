#pragma once
// evaluate_run: the files of a run and the truth of its data set -> all metrics. What `eval`, `ablate` and `demo` print
// comes from here; judge_run keeps the run and the truth as well, for `report`. Thread-bound.

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/evaluation/evaluation.h"
#include "firmware-host/pelorus/eval/eval_goals.h"
#include "firmware-host/pelorus/results/lost_pairs.h"
#include "firmware-host/pelorus/results/result_reader.h"

namespace pelorus {

struct RunEvaluation {
  std::string dataset;
  std::string folder;
  Evaluation evaluation;  // without truth: the facts only
  std::optional<StepTimes> step_times;
  std::optional<LostPairs> lost;  // absent where the run does not tell
  bool has_truth = false;
  bool exact_truth = false;
  bool scale_known = true;
  std::string truth_origin;
  std::optional<std::string> doubt;       // why the truth may be that of another run (truth_doubt)
  Goals goals;                            // of the data set
  std::optional<std::string> incomplete;  // why the run's files hold less than the recording (IncompleteMark)
};

struct JudgedRun {
  EstimatedRun run;
  std::string cut;  // what is missing at its end (read_run)
  std::optional<Truth> truth;
  RunEvaluation evaluation;
};

// An empty `dataset` says that nothing is known beside the run.
[[nodiscard]] Result<JudgedRun> judge_run(const std::string& dataset, const std::string& calibration_file,
                                          const std::filesystem::path& folder, const EvaluationConfig& config);

[[nodiscard]] Result<RunEvaluation> evaluate_run(const std::string& dataset, const std::string& calibration_file,
                                                 const std::filesystem::path& folder, const EvaluationConfig& config);

}  // namespace pelorus
