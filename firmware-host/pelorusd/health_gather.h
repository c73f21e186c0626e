#pragma once
// Counters of all parts of the service into those of one health report. Pure but for reading the counters.

#include <vector>

#include "services/capture.h"
#include "services/health_report.h"
#include "services/vision.h"

namespace pelorus {

void gather_capture(const std::vector<CaptureStatus>& cameras, const SyncStatistics& sync, HealthReport& report);
void gather_vision(const VisionStatus& vision, HealthReport& report);

}  // namespace pelorus
