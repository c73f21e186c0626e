#pragma once
// The effects of leaving steps out, one row per run, for people and for scripts. Pure.

#include <optional>
#include <string>
#include <vector>

#include "firmware-host/pelorus/eval/eval_run.h"

namespace pelorus {

struct AblationRun {
  std::string step_off;  // empty: every step is on
  std::optional<RunEvaluation> result;
  std::string failure;  // why there is no result
  ErrorCode failure_code = ErrorCode::bad_input;
  bool broke_off = false;  // the recording, see failure
  std::string incomplete;  // what the run went on without; empty: nothing
};

// One run in figures. Over the bodies: mean of the medians (ME), of the means (since birth) and of the coverages, sums
// of the rest.
struct AblationFigures {
  double camera_step_m = 0;
  double camera_absolute_m = 0;
  double motion_m = 0;
  double motion_rad = 0;
  double since_birth_m = 0;
  double since_birth_rad = 0;
  double coverage = 0;
  int identity_switches = 0;
  std::size_t false_objects = 0;
  double right_count_share = 0;
  double step_median_ms = 0;
  bool has_bodies = false;
};

[[nodiscard]] AblationFigures ablation_figures(const RunEvaluation& run);
[[nodiscard]] std::string to_table(const std::vector<AblationRun>& runs);
[[nodiscard]] std::string to_json(const std::vector<AblationRun>& runs);

}  // namespace pelorus
