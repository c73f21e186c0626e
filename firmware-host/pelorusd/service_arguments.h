#pragma once
// The command line of the service in one place: the program parses with it, its manual page is made from it.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pelorus {

struct ServiceArguments {
  std::vector<std::string> configs;
  bool check_config = false;
};

// `arguments` has to live as long as the parser.
void add_service_arguments(CLI::App& parser, ServiceArguments& arguments);

}  // namespace pelorus
