// pelorusd: the service. Reads its configuration, runs until it is told to stop, explains on stderr what keeps it from
// starting. Exit codes: docs/service.md.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "firmware-host/pelorusd/app.h"
#include "firmware-host/pelorusd/service_arguments.h"
#include "firmware-host/runtime/config_loader.h"
#include "firmware-host/runtime/settings_hash.h"
#include "firmware-host/runtime/standard_output.h"

namespace {

using pelorus::Error;
using pelorus::ErrorCode;
using pelorus::ServiceArguments;

// The settings of all files, each on top of those before it. The problems of all files are told at once.
pelorus::Result<pelorus::ServiceConfig> load(const std::vector<std::string>& files) {
  pelorus::ServiceConfig config;
  std::string problems;
  ErrorCode code = ErrorCode::bad_configuration;
  for (const std::string& file : files) {
    const pelorus::Result<> applied = pelorus::apply_config_file(file, config);
    if (applied) continue;
    problems += (problems.empty() ? "" : "\n") + applied.error().message();
    code = applied.error().code;
  }
  const bool needs_path = config.source.kind == "replay" || config.source.kind == "synthetic";
  if (problems.empty() && needs_path && config.source.path.empty()) {
    problems = files.back() + ": source.path is not given (write where the pairs come from)";
  }
  if (!problems.empty()) return Error{code, "configuration", problems, ""};
  return config;
}

int check(const pelorus::ServiceConfig& config) {
  const std::string changed = pelorus::changed_settings(config);
  std::printf("configuration %s is good\n", pelorus::config_hash(config).c_str());
  std::printf("different from the defaults: %s\n", changed.empty() ? "nothing" : changed.c_str());
  const pelorus::Result<> printed = pelorus::flush_standard_output();
  if (printed) return 0;
  std::fprintf(stderr, "pelorusd: %s\n", printed.error().message().c_str());
  return pelorus::exit_code(printed.error().code);
}

int run_service(int argc, char** argv) {
  CLI::App parser;
  ServiceArguments arguments;
  add_service_arguments(parser, arguments);
  try {
    parser.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return parser.exit(e) == 0 ? 0 : pelorus::exit_code(ErrorCode::bad_usage);
  }
  pelorus::LogSink log(pelorus::stderr_is_journal());
  const auto config = load(arguments.configs);
  if (!config) {
    log.line(pelorus::LogLevel::error, config.error().message());
    return pelorus::exit_code(config.error().code);
  }
  if (arguments.check_config) return check(config.value());
  pelorus::block_signals();
  log.line(pelorus::LogLevel::notice, "pelorusd " PELORUS_VERSION);
  const auto app = pelorus::App::create(config.value(), log);
  if (!app) {
    log.line(pelorus::LogLevel::error, app.error().message());
    return pelorus::exit_code(app.error().code);
  }
  return app.value()->run();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_service(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "pelorusd: unexpected failure: %s\n", e.what());
    return 1;
  }
}
