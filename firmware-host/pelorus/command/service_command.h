#pragma once
// `pelorus command`: a request to the running service over LCM (VIS_COMMAND), and its answer.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 accepted; 1 refused, or no answer in time; 2 usage; 5 configuration; 6 LCM cannot be opened; 130
// interrupted.
[[nodiscard]] Verb add_command(CLI::App& app);

}  // namespace pelorus
