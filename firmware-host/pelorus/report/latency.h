#pragma once
// latency_histogram: how long frames took, in bins of equal width on a logarithmic scale, with the quantiles that a
// real-time system is judged by (nearest_rank). Pure.

#include <cstdint>
#include <vector>

namespace pelorus {

struct LatencyBin {
  double low_ms = 0;
  double high_ms = 0;
  std::int64_t frames = 0;
};

struct LatencyHistogram {
  std::vector<LatencyBin> bins;  // adjoining, from the smallest to the largest value
  std::int64_t frames = 0;       // 0: the others mean nothing
  double mean_ms = 0;
  double p50_ms = 0;
  double p99_ms = 0;
  double p999_ms = 0;
  double max_ms = 0;
};

[[nodiscard]] LatencyHistogram latency_histogram(std::vector<double> times_ms);

}  // namespace pelorus
