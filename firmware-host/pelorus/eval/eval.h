#pragma once
// `pelorus eval`: a run's results against the truth of its data set.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 evaluated; 2 usage; 3 bad input or no truth (what can be said without it is printed); 4 calibration.
[[nodiscard]] Verb add_eval(CLI::App& app);

}  // namespace pelorus
