#pragma once
// A verb of the tool: add_<verb> puts its options on the parser; run() does the work once parsing succeeded and
// returns the process exit code (0 = success). One file per verb.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdint>
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

// Counts: a number that wraps around or is cut to what an integer holds would be another one than was written.
[[nodiscard]] inline CLI::Validator count_above_zero() {
  return {[](std::string& text) {
            std::string problem = above_zero()(text);
            int number = 0;
            const char* const end = text.data() + text.size();
            const auto [rest, error] = std::from_chars(text.data(), end, number);
            if (problem.empty() && (error != std::errc{} || rest != end))
              problem = "'" + text + "' is not a whole number from 1 to 2147483647";
            return problem;
          },
          "above 0"};
}

[[nodiscard]] inline CLI::Validator whole_from_zero() {
  return {[](std::string& text) {
            std::uint64_t number = 0;
            const char* const end = text.data() + text.size();
            const auto [rest, error] = std::from_chars(text.data(), end, number);
            const bool good = error == std::errc{} && rest == end;
            return good ? std::string() : "'" + text + "' is not a whole number from 0 to 18446744073709551615";
          },
          "0 or above"};
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
