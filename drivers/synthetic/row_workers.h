#pragma once
// Runs a function over the rows of a picture on several threads; returns when all are done. Rows are independent, so
// the result does not depend on the number of threads.

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace pelorus::synthetic {

template <class RowFunction>
void for_each_row(int rows, int threads, const RowFunction& run_row) {
  constexpr int kRowsPerTake = 8;
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int first = next.fetch_add(kRowsPerTake); first < rows; first = next.fetch_add(kRowsPerTake)) {
      const int last = std::min(rows, first + kRowsPerTake);
      for (int row = first; row < last; ++row) run_row(row);
    }
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < threads; ++i) helpers.emplace_back(work);
  work();
}

}  // namespace pelorus::synthetic
