#pragma once
// `pelorus ablate`: what each step of the method is worth: replay and evaluation with one switch of MethodSteps off at
// a time (the question of the paper's section 7).

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Exit codes: 0 done (runs that failed are shown as such); 2 usage; 3 bad input or no truth; 6 output; 130 interrupted,
// the table shows the runs made until then.
[[nodiscard]] Verb add_ablate(CLI::App& app);

}  // namespace pelorus
