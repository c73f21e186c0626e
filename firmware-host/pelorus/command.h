#pragma once
// A verb of the tool: add_<verb> puts its options on the parser; run() does the work once parsing succeeded and
// returns the process exit code (0 = success). One file per verb.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
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
            char* end = nullptr;
            const bool good = std::strtod(text.c_str(), &end) > 0 && *end == '\0';
            return good ? std::string() : "'" + text + "' is not a number above 0";
          },
          "above 0"};
}

// CLI::IsMember, whose message tells neither what to do nor, after a transformation, the words themselves.
[[nodiscard]] inline CLI::Validator one_of(const std::vector<std::string>& words) {
  std::string all;
  std::string choices;  // in the form of the help, which the completion of the shell is made of
  for (const std::string& word : words) {
    all += (all.empty() ? "" : ", ") + word;
    choices += (choices.empty() ? "" : ",") + word;
  }
  return {[words, all](std::string& text) {
            const bool known = std::find(words.begin(), words.end(), text) != words.end();
            return known ? std::string() : "'" + text + "' is unknown (give one of: " + all + ")";
          },
          "{" + choices + "}"};
}

}  // namespace pelorus
