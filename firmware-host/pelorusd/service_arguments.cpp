#include "firmware-host/pelorusd/service_arguments.h"

namespace pelorus {
namespace {

// CLI11 does not name a word that it does not know when something else is missing too.
std::string usage_text(const CLI::App* app, const CLI::Error& error) {
  std::string what = error.what();
  for (const std::string& word : app->remaining()) {
    if (word == "--") continue;
    what = "'" + word + (word.starts_with('-') ? "' is no option of pelorusd" : "' is not expected");
    break;
  }
  return "pelorusd: " + what + " (pelorusd --help tells what there is)\n";
}

}  // namespace

void add_service_arguments(CLI::App& parser, ServiceArguments& arguments) {
  parser.description("Pelorus: the vehicle's motion and the tracks of moving rigid bodies, live.");
  parser.failure_message(usage_text);
  parser.set_version_flag("--version", "pelorusd " PELORUS_VERSION);
  parser.add_option("--config", arguments.configs, "Settings file (config/pelorus.yaml); several apply in turn")
      ->required()
      ->allow_extra_args(false);
  parser.add_flag("--check-config", arguments.check_config, "Check the settings, tell all problems, and end");
  parser.footer(
      "Exit codes: 0 stopped or recording at its end, 1 unexpected, 2 usage, 3 source, 4 calibration, 5 "
      "configuration,\n"
      "6 a file cannot be read, or the output not be written. See docs/service.md.");
}

}  // namespace pelorus
