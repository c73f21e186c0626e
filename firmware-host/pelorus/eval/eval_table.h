#pragma once
// The evaluation as a table for people: each figure beside the goal that the data set has for it, if any, and what the
// paper reached. Pure.

#include <string>

#include "firmware-host/pelorus/eval/eval_run.h"

namespace pelorus {

[[nodiscard]] std::string to_table(const RunEvaluation& run);

}  // namespace pelorus
