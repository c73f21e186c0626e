#pragma once
// What a latency run says: distributions of every stage and of the whole, as table and as JSON. Pure.

#include <string>
#include <vector>

#include "firmware-host/pelorus/bench/latency_run.h"
#include "firmware-host/pelorus/doctor/scheduling.h"

namespace pelorus {

struct Distribution {
  std::string name;
  std::string unit;
  std::vector<double> values;  // sorted

  [[nodiscard]] double at(double share) const;  // 0 = least, 1 = greatest; NaN when empty
};

// Stages, step, time to the end of the step, time to release, lateness of the release.
[[nodiscard]] std::vector<Distribution> distributions(const LatencyRun& run);

struct LatencyContext {
  LatencyOptions options;
  std::string dataset;
  int width = 0;
  int height = 0;
  WakeupDelays host;  // measured before, so that a bad kernel is not blamed on us
};

[[nodiscard]] std::string latency_table(const LatencyContext& context, const LatencyRun& run);
[[nodiscard]] std::string latency_json(const LatencyContext& context, const LatencyRun& run);

}  // namespace pelorus
