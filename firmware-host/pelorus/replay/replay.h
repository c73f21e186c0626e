#pragma once
// `pelorus replay`: recorded frames through the pipeline into result files.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 done; 2 usage; 3 bad input (also midway or for a single skipped pair: what was processed is kept);
// 4 calibration; 5 configuration; 6 output; 130 interrupted, files valid.
[[nodiscard]] Verb add_replay(CLI::App& app);

}  // namespace pelorus
