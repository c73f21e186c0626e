// pelorusd: the service. Reads its configuration, runs until it is told to stop, explains on stderr what keeps it from
// starting. Exit codes: docs/service.md.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "firmware-host/pelorusd/app.h"
#include "firmware-host/pelorusd/service_arguments.h"
#include "firmware-host/runtime/camera_config.h"
#include "firmware-host/runtime/config_loader.h"
#include "firmware-host/runtime/settings_hash.h"
#include "firmware-host/runtime/standard_output.h"

namespace {

using pelorus::Error;
using pelorus::ErrorCode;
using pelorus::ServiceArguments;

// What a service needs beside settings that fit each other.
std::vector<pelorus::ConfigConflict> start_conflicts(const pelorus::ServiceConfig& config) {
  if (const auto missing = pelorus::missing_driver(config.source.kind))
    return {{{"source.kind"}, missing->what, missing->cure}};
  const bool needs_path = config.source.kind == "replay" || config.source.kind == "synthetic";
  if (!needs_path || !config.source.path.empty()) return {};
  return {{{"source.path", "source.kind"}, "source.path is not given", "write where the pairs come from"}};
}

// What was printed has been taken: 0, else told and 6.
int printed_exit_code() {
  const pelorus::Result<> printed = pelorus::flush_standard_output();
  if (printed) return 0;
  std::fprintf(stderr, "pelorusd: %s\n", printed.error().message().c_str());
  return pelorus::exit_code(printed.error().code);
}

int check(const pelorus::ServiceConfig& config) {
  const std::string changed = pelorus::changed_settings(config);
  std::printf("configuration %s is good\n", pelorus::config_hash(config).c_str());
  std::printf("different from the defaults: %s\n", changed.empty() ? "nothing" : changed.c_str());
  return printed_exit_code();
}

int run_service(int argc, char** argv) {
  CLI::App parser;
  ServiceArguments arguments;
  add_service_arguments(parser, arguments);
  try {
    parser.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return parser.exit(e) == 0 ? printed_exit_code() : pelorus::exit_code(ErrorCode::bad_usage);
  }
  pelorus::LogSink log(pelorus::stderr_is_journal());
  pelorus::ServiceConfig config;
  if (const auto applied = pelorus::apply_config_files(arguments.configs, config, start_conflicts); !applied) {
    log.line(pelorus::LogLevel::error, applied.error().message());
    return pelorus::exit_code(applied.error().code);
  }
  if (arguments.check_config) return check(config);
  pelorus::block_signals();
  log.line(pelorus::LogLevel::notice, "pelorusd " PELORUS_VERSION);
  const auto app = pelorus::App::create(config, log);
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
