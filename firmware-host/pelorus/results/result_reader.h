#pragma once
// read_run: the files of a run (result_files.h) back into an EstimatedRun. camera.tum alone is enough, so that other
// systems' trajectories can be judged too; frames.csv adds frames without a pose, states and covariances, objects.csv
// the objects, both required only for what they carry. Files that do not hold what frames.csv says are refused, but for
// a run with an IncompleteMark whose files were cut off at their ends: it ends with the last frame that all of them
// hold. A missing objects.csv holds no rows. Errors name file and line. Thread-bound.

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/evaluation/records.h"

namespace pelorus {

// `cut`: what was left away at the end; empty when nothing was.
[[nodiscard]] Result<EstimatedRun> read_run(const std::filesystem::path& folder, std::string* cut = nullptr);

struct StepTimes {
  double median_ms = 0;
  double p99_ms = 0;
};

// From timing.csv; absent when there is none or it is empty.
[[nodiscard]] Result<std::optional<StepTimes>> read_step_times(const std::filesystem::path& folder);

}  // namespace pelorus
