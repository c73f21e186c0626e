#pragma once
// The whole round of checks before a dive, in the order in which they are shown. Takes about four seconds: two of
// timer, one or two of looking for cameras. Main thread.

#include <chrono>
#include <vector>

#include "firmware-host/pelorus/doctor/host_check.h"
#include "firmware-host/pelorus/doctor/host_files.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

struct CheckupOptions {
  bool configured = false;                    // settings were given: what they name has to be there
  std::chrono::milliseconds timer_run{2000};  // of the scheduling latency
};

[[nodiscard]] std::vector<HostCheck> check_host(const ServiceConfig& config, const HostFiles& files,
                                                const CheckupOptions& options);

}  // namespace pelorus
