#pragma once
// A verb of the tool: add_<verb> puts its options on the parser; run() does the work once parsing succeeded and
// returns the process exit code (0 = success). One file per verb.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <string>
#include <vector>

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

// CLI::IsMember, whose message tells neither what to do nor, after a transformation, the words themselves.
[[nodiscard]] inline CLI::Validator one_of(const std::vector<std::string>& words) {
  const std::string all = CLI::detail::join(words, ", ");
  return {[words, all](std::string& text) {
            const bool known = std::find(words.begin(), words.end(), text) != words.end();
            return known ? std::string() : "'" + text + "' is unknown (give one of: " + all + ")";
          },
          "{" + CLI::detail::join(words, ",") + "}"};
}

}  // namespace pelorus
