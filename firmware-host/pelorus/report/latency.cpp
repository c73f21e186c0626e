#include "firmware-host/pelorus/report/latency.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/nearest_rank.h"

namespace pelorus {
namespace {

constexpr double kBinsPerDecade = 20;
constexpr double kShortest_ms = 1e-3;  // the clock's resolution in the file

}  // namespace

LatencyHistogram latency_histogram(std::vector<double> times_ms) {
  LatencyHistogram histogram;
  if (times_ms.empty()) return histogram;
  std::sort(times_ms.begin(), times_ms.end());
  const auto bin_of = [](double time_ms) {
    return static_cast<int>(std::floor(std::log10(std::max(time_ms, kShortest_ms)) * kBinsPerDecade + 1e-9));
  };
  const auto edge = [](int bin) { return std::pow(10.0, bin / kBinsPerDecade); };
  const int first = bin_of(times_ms.front());
  for (int bin = first; bin <= bin_of(times_ms.back()); ++bin) histogram.bins.push_back({edge(bin), edge(bin + 1), 0});
  for (const double time_ms : times_ms) ++histogram.bins[static_cast<std::size_t>(bin_of(time_ms) - first)].frames;
  histogram.frames = static_cast<std::int64_t>(times_ms.size());
  histogram.mean_ms = std::accumulate(times_ms.begin(), times_ms.end(), 0.0) / static_cast<double>(times_ms.size());
  histogram.p50_ms = nearest_rank(times_ms, 0.5);
  histogram.p99_ms = nearest_rank(times_ms, 0.99);
  histogram.p999_ms = nearest_rank(times_ms, 0.999);
  histogram.max_ms = times_ms.back();
  return histogram;
}

}  // namespace pelorus
