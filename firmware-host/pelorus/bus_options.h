// Which bus a verb speaks on: the LCM settings of the service, with --config, --url and --vehicle on its command line.
// Errors name file and line. Called from one thread.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

class BusOptions {
 public:
  void add_to(CLI::App& parser);
  [[nodiscard]] Result<LcmConfig> resolve() const;

 private:
  std::vector<std::string> configs_;
  std::string url_;
  std::string vehicle_;
};

}  // namespace pelorus
