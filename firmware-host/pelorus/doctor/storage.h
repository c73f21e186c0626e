#pragma once
// Where recordings go: room and right to write. Asks the file system.

#include <cstdint>
#include <optional>

#include "firmware-host/pelorus/doctor/host_check.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

// Of the pairs that would be recorded, raw.
struct PairFlow {
  std::uint64_t bytes = 0;
  double rate_hz = 0;
};

// FAIL only when the service shall record from its start. Without `flow` no time is told.
[[nodiscard]] HostCheck check_storage(const RecorderConfig& config, const std::optional<PairFlow>& flow);

}  // namespace pelorus
