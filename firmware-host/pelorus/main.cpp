// pelorus: the tool. Parses the verb, runs it, turns an Error into one line on stderr and an exit code.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <vector>

#include "firmware-host/pelorus/verbs.h"

namespace {

int run_tool(int argc, char** argv) {
  CLI::App app;
  const std::vector<pelorus::Verb> verbs = pelorus::add_verbs(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : pelorus::exit_code(pelorus::ErrorCode::bad_usage);
  }
  for (const pelorus::Verb& verb : verbs) {
    if (!verb.parser->parsed()) continue;
    const pelorus::Result<int> outcome = verb.run();
    if (outcome.ok()) return outcome.value();
    std::fprintf(stderr, "pelorus: %s\n", outcome.error().message().c_str());
    return pelorus::exit_code(outcome.error().code);
  }
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_tool(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "pelorus: unexpected failure: %s\n", e.what());
    return 1;
  }
}
