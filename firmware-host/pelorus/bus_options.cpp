#include "firmware-host/pelorus/bus_options.h"

#include "firmware-host/runtime/config_loader.h"
#include "firmware-host/runtime/lcm_url.h"

namespace pelorus {

void BusOptions::add_to(CLI::App& parser) {
  parser.add_option("--config", configs_, "Settings file of the service, for lcm.url and lcm.vehicle")
      ->allow_extra_args(false);
  parser.add_option("--url", url_, "LCM's address in place of lcm.url");
  parser.add_option("--vehicle", vehicle_, "First part of the channels' names in place of lcm.vehicle");
}

Result<LcmConfig> BusOptions::resolve() const {
  ServiceConfig config;
  if (const Result<Ok> applied = apply_config_files(configs_, config); !applied) return applied.error();
  if (!url_.empty()) config.lcm.url = url_;
  if (!url_.empty() && !is_lcm_url(url_))
    return Error{ErrorCode::io, "--url", "'" + url_ + "' is no address of LCM", kLcmUrlCure};
  if (!vehicle_.empty()) config.lcm.vehicle = vehicle_;
  return config.lcm;
}

}  // namespace pelorus
