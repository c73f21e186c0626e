#pragma once
// `pelorus doctor`: is this computer ready for a dive?

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 no check failed, 1 at least one did, 2 usage, 5 configuration, 6 a file cannot be read.
[[nodiscard]] Verb add_doctor(CLI::App& app);

}  // namespace pelorus
