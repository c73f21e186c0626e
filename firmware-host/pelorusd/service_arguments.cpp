#include "firmware-host/pelorusd/service_arguments.h"

namespace pelorus {

void add_service_arguments(CLI::App& parser, ServiceArguments& arguments) {
  parser.description("Pelorus: the vehicle's motion and the tracks of moving rigid bodies, live.");
  parser.set_version_flag("--version", "pelorusd " PELORUS_VERSION);
  parser.add_option("--config", arguments.configs, "Settings file (config/pelorus.yaml); several apply in turn")
      ->required()
      ->allow_extra_args(false);
  parser.add_flag("--check-config", arguments.check_config, "Check the settings, tell all problems, and end");
  parser.footer(
      "Exit codes: 0 stopped or recording at its end, 1 unexpected, 2 usage, 3 source, 4 calibration, 5 "
      "configuration,\n"
      "6 a file cannot be read, 7 device. See docs/service.md.");
}

}  // namespace pelorus
