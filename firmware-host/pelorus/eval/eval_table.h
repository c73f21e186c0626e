#pragma once
// The evaluation as a table for people: each figure beside the goal of method.md section 10 and what the paper reached.
// Goals in centimetres speak of synthetic dives and are shown for exact truth only; drift goals for roads. Pure.

#include <string>

#include "firmware-host/pelorus/eval/eval_run.h"

namespace pelorus {

[[nodiscard]] std::string to_table(const RunEvaluation& run);

}  // namespace pelorus
