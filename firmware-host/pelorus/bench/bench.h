#pragma once
// Verb `bench`: measures the service on this computer. See bench.cpp for the parts.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

[[nodiscard]] Verb add_bench(CLI::App& app);

}  // namespace pelorus
