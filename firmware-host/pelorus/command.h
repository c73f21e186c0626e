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

// CLI::PositiveNumber, whose message lists the range of double, in words.
[[nodiscard]] inline CLI::Validator above_zero() {
  return {[](std::string& text) {
            double value = 0;
            const bool good = CLI::detail::lexical_cast(text, value) && value > 0;
            return good ? std::string() : "'" + text + "' is not a number above 0";
          },
          "above 0"};
}

}  // namespace pelorus
