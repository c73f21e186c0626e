#pragma once
// Manual pages (man(7) macros) from a parser of CLI11, so that they say what --help says. Pure.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pelorus {

struct ManualFacts {
  std::string program;   // "pelorus"
  std::string section;   // "1"
  std::string version;   // "0.1.0"
  std::string see_also;  // roff text: "\\fBpelorusd\\fR(8)"
};

struct ManPage {
  std::string file_name;  // "pelorus-replay.1"
  std::string text;
};

// One page for the program, then one for each verb; verbs of a verb are sections of its page.
[[nodiscard]] std::vector<ManPage> man_pages(const CLI::App& parser, const ManualFacts& facts);

}  // namespace pelorus
