#pragma once
// `pelorus synth SCENE --out DIR`: renders a synthetic dive with exact truth as an EuRoC ASL folder.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

[[nodiscard]] Verb add_synth(CLI::App& app);

}  // namespace pelorus
