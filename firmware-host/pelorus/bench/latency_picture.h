#pragma once
// Histograms of a latency run as a picture: what the step took, and how late results left. Counts on a logarithmic
// scale, since the rare late one is what matters.

#include <filesystem>

#include "core/base/result.h"
#include "firmware-host/pelorus/bench/latency_report.h"

namespace pelorus {

// Errors: io.
[[nodiscard]] Result<> write_latency_picture(const std::filesystem::path& file, const LatencyContext& context,
                                             const LatencyRun& run);

}  // namespace pelorus
