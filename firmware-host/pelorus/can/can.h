#pragma once
// `pelorus can dump|dbc|export`: decodes the CAN frames live or from a candump log; writes the contract out.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

Verb add_can(CLI::App& app);

}  // namespace pelorus
