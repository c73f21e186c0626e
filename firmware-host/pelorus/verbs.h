#pragma once
// The command line of the tool in one place: the program parses with it, the manual pages are made from it.

#include <CLI/CLI.hpp>
#include <vector>

#include "firmware-host/pelorus/command.h"

namespace pelorus {

// Puts description, --version and every verb on the parser; the verbs in the order of --help.
[[nodiscard]] std::vector<Verb> add_verbs(CLI::App& app);

}  // namespace pelorus
