// pelorus: the tool. Parses the verb, runs it, turns an Error into one line on stderr and an exit code, that of output
// which did not arrive too.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <vector>

#include "firmware-host/pelorus/verbs.h"
#include "firmware-host/runtime/standard_output.h"

namespace {

int tell(const pelorus::Error& error) {
  std::fprintf(stderr, "pelorus: %s\n", error.message().c_str());
  return pelorus::exit_code(error.code);
}

// The code of a verb that said what it had to say, if that could be written.
int delivered(int code) {
  const pelorus::Result<> printed = pelorus::flush_standard_output();
  return printed ? code : tell(printed.error());
}

int run_tool(int argc, char** argv) {
  CLI::App app;
  const std::vector<pelorus::Verb> verbs = pelorus::add_verbs(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? delivered(0) : pelorus::exit_code(pelorus::ErrorCode::bad_usage);
  }
  for (const pelorus::Verb& verb : verbs) {
    if (!verb.parser->parsed()) continue;
    const pelorus::Result<int> outcome = verb.run();
    return outcome.ok() ? delivered(outcome.value()) : tell(outcome.error());
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
