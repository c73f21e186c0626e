#pragma once
// A verb of the tool: add_<verb> puts its options on the parser; run() does the work once parsing succeeded and
// returns the process exit code (0 = success). One file per verb.

#include <CLI/CLI.hpp>
#include <functional>

#include "core/base/result.h"

namespace pelorus {

struct Verb {
  CLI::App* parser = nullptr;
  std::function<Result<int>()> run;
};

}  // namespace pelorus
