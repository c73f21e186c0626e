#pragma once
// `pelorus top`: what the service is doing, on a terminal.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 ended by the user, or --once done; 1 --once: not every channel heard in time; 2 usage; 5 configuration;
// 6 a file cannot be read, or no bus.
[[nodiscard]] Verb add_top(CLI::App& app);

}  // namespace pelorus
