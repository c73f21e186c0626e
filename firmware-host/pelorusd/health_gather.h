#pragma once
// Counters of all parts of the service into those of one health report. Pure but for reading the counters.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware-host/pelorusd/service_threads.h"

namespace pelorus {

// `worst_sync_error_ns`: of the pairs since the last report, none without a pair.
void gather_capture(const std::vector<CaptureStatus>& cameras, const SyncStatistics& sync,
                    std::optional<std::int64_t> worst_sync_error_ns, HealthReport& report);
void gather_vision(const VisionStatus& vision, HealthReport& report);
void gather_can(const CanStatus& can, const std::string& interface, HealthReport& report);
void gather_recorder(const RecorderStatus& recorder, HealthReport& report);
// All of the above and what else the parts know. Takes what is measured from one report to the next.
void gather_service(const ServiceThreads& service, HealthReport& report);

// An output that does not work, and why: for the log and systemd's status line, which need neither network nor bus.
struct OutputTrouble {
  const char* output;
  std::string text;
};
[[nodiscard]] std::vector<OutputTrouble> output_troubles(const ServiceThreads& service, const HealthReport& report);

// Words that change when the CAN bus, the recorder or LCM begins or ceases to work, and at nothing else.
[[nodiscard]] std::string outputs_state(const ServiceThreads& service);

}  // namespace pelorus
