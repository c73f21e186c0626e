#pragma once
// `pelorus replay`: recorded frames through the pipeline into result files.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 done; 2 usage; 3 bad input (also for a single missing or skipped pair); 4 calibration; 5 configuration;
// 6 output; 8 the recording broke off; 130 interrupted. Whatever was processed is kept.
[[nodiscard]] Verb add_replay(CLI::App& app);

}  // namespace pelorus
