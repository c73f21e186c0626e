#pragma once
// `pelorus export`: a run's results in the formats of other tools.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 written; 2 usage; 3 no run, or nothing in it to write; 6 input/output.
[[nodiscard]] Verb add_export(CLI::App& app);

}  // namespace pelorus
