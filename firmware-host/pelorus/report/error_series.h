#pragma once
// error_series: the errors behind the figures of `eval`, frame by frame, as the paper's Fig. 9 shows them: local (of
// one step) and absolute (since the first common pose; of a body since its estimate's birth), displacement and
// orientation. Same definitions and same frames as core/evaluation (trajectory_error.h, motion_error.h): the mean of
// each series is the mean that `eval` prints, and a test holds that. Pure.

#include <string>
#include <vector>

#include "core/evaluation/association.h"
#include "core/evaluation/records.h"

namespace pelorus {

// NaN where a frame has no such error.
struct ErrorSample {
  std::size_t frame = 0;
  BodyId object;  // of a body: the estimate that was it in this frame
  double step_m = 0;
  double step_rad = 0;
  double absolute_m = 0;
  double absolute_rad = 0;
};

struct BodyErrors {
  int body = 0;  // index into Truth::bodies
  std::vector<ErrorSample> samples;
};

struct ErrorSeries {
  std::vector<ErrorSample> camera;
  std::vector<BodyErrors> bodies;  // those that an object was matched with
};

[[nodiscard]] ErrorSeries error_series(const EstimatedRun& run, const Truth& truth, const AssociationConfig& config);

}  // namespace pelorus
