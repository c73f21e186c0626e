#pragma once
// Completion of a command line in bash, from a parser of CLI11: verbs, options, the values of options that have a
// fixed choice, file names elsewhere. Pure.

#include <CLI/CLI.hpp>
#include <string>

namespace pelorus {

[[nodiscard]] std::string bash_completion(const CLI::App& parser, const std::string& program);

}  // namespace pelorus
