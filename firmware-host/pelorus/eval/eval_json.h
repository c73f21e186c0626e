#pragma once
// The evaluation as JSON for scripts: SI units and radians, the unit at the end of each key; figures that do not exist
// are null. Pure.

#include <string>

#include "firmware-host/pelorus/eval/eval_run.h"

namespace pelorus {

[[nodiscard]] std::string to_json(const RunEvaluation& run);

}  // namespace pelorus
