#include "core/evaluation/error_statistics.h"

#include <algorithm>
#include <cmath>

namespace pelorus {

ErrorStatistics summarize(std::vector<double> errors) {
  ErrorStatistics statistics;
  statistics.count = errors.size();
  if (errors.empty()) return statistics;
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  double sum_of_squares = 0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  const auto count = static_cast<double>(errors.size());
  const std::size_t middle = errors.size() / 2;
  statistics.mean = sum / count;
  statistics.median = errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  statistics.rmse = std::sqrt(sum_of_squares / count);
  statistics.max = errors.back();
  return statistics;
}

}  // namespace pelorus
