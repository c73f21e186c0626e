#pragma once
// `pelorus demo`: the paper's experiment from nothing: render, process, judge. What `./run demo` calls.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 done (goals met or not: the table says); 2 usage; 6 output; 130 interrupted.
[[nodiscard]] Verb add_demo(CLI::App& app);

}  // namespace pelorus
