#pragma once
// Mean, median, RMSE and maximum of a list of errors, never one of them alone. Pure.

#include <cstddef>
#include <vector>

namespace pelorus {

struct ErrorStatistics {
  std::size_t count = 0;  // 0: the others mean nothing
  double mean = 0;
  double median = 0;
  double rmse = 0;
  double max = 0;
};

[[nodiscard]] ErrorStatistics summarize(std::vector<double> errors);

}  // namespace pelorus
