#pragma once
// nearest_rank: the quantile of a share is the smallest measured value that at least this share of the values does not
// exceed: p99 of 90 values is the largest of them, and nothing is interpolated beyond what was measured. Pure.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace pelorus {

// Of sorted values; share 0 = the least, 1 = the greatest. NaN when there are none.
[[nodiscard]] inline double nearest_rank(std::span<const double> sorted, double share) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  constexpr double kRounding = 1e-9;  // 0.99 * 1000 is a little more than 990
  const double rank = std::ceil(share * static_cast<double>(sorted.size()) - kRounding);
  const auto index = static_cast<std::size_t>(std::max(1.0, rank)) - 1;
  return sorted[std::min(index, sorted.size() - 1)];
}

}  // namespace pelorus
