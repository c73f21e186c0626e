#pragma once
// UnitLimits: what an installed pelorusd.service and its drop-ins grant the service, read from the unit files as
// systemd would: folders in their order of rank, drop-ins by name, the last word counts (systemd.unit(5)). Pure
// reading.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware-host/pelorus/doctor/host_check.h"
#include "firmware-host/pelorus/doctor/host_files.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

struct UnitLimits {
  std::string path;  // of the unit file
  int drop_ins = 0;
  std::map<std::string, std::string> service;  // section [Service]: key to its last value

  // Empty when the key is not set.
  [[nodiscard]] std::string value(const std::string& key) const;
  [[nodiscard]] bool grants_realtime() const;
  [[nodiscard]] bool grants_locked_memory() const;
  [[nodiscard]] bool grants_raw_network() const;
};

// None when the unit is not installed.
[[nodiscard]] std::optional<UnitLimits> read_unit(const HostFiles& files);

// Whether the unit grants what the configuration asks for.
[[nodiscard]] HostCheck check_unit(const std::optional<UnitLimits>& unit, const ServiceConfig& config);

}  // namespace pelorus
