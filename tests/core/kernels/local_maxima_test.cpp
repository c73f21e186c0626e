#include "core/kernels/local_maxima.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/core/kernels/each_target.h"

namespace pelorus {
namespace {

// Three layers of three rows of 64 samples and room to read past them.
struct Stack {
  std::vector<float> values = std::vector<float>(9 * 96, 0.0F);
  LayerRows rows;

  Stack() {
    for (std::size_t k = 0; k < 9; ++k) rows[k / 3][k % 3] = values.data() + 96 * k;
  }
  float& at(std::size_t layer, std::size_t row, std::size_t i) { return values[96 * (3 * layer + row) + i]; }
  std::vector<std::int32_t> maxima(int first, int count, float threshold) const {
    std::vector<std::int32_t> found(static_cast<std::size_t>(count));
    found.resize(static_cast<std::size_t>(local_maxima(rows, first, count, threshold, found.data())));
    return found;
  }
};

TEST(LocalMaxima, VectorPathsFindWhatTheReferenceFinds) {
  for_each_target([] {
    std::mt19937 rng(3);
    std::uniform_int_distribution<int> level(0, 6);  // coarse steps: plenty of equals
    for (int round = 0; round < 200; ++round) {
      Stack stack;
      for (float& v : stack.values) v = static_cast<float>(level(rng));
      const int first = 1 + round % 5;
      const int count = 3 + round % 50;
      std::vector<std::int32_t> expected(static_cast<std::size_t>(count));
      const int size = reference::local_maxima(stack.rows, first, count, 2.0F, expected.data());
      expected.resize(static_cast<std::size_t>(size));
      EXPECT_EQ(stack.maxima(first, count, 2.0F), expected);
    }
  });
}

TEST(LocalMaxima, FindsAPeakAmongAllItsNeighboursAndNotOneThatANeighbourTops) {
  for (std::size_t k = 0; k < 27; ++k) {
    Stack stack;
    stack.at(1, 1, 20) = 5;
    EXPECT_EQ(stack.maxima(1, 62, 1.0F), std::vector<std::int32_t>{20});
    if (k == 13) continue;
    stack.at(k / 9, k / 3 % 3, 19 + k % 3) = 6;
    const auto found = stack.maxima(1, 62, 1.0F);
    EXPECT_EQ(std::count(found.begin(), found.end(), 20), 0) << k;
  }
}

TEST(LocalMaxima, OfTwoEqualNeighboursExactlyOneIsFound) {
  Stack stack;
  stack.at(1, 1, 30) = stack.at(1, 1, 31) = 4;
  EXPECT_EQ(stack.maxima(1, 62, 1.0F).size(), 1U);
}

TEST(LocalMaxima, NothingBelowTheThresholdIsFound) {
  Stack stack;
  stack.at(1, 1, 30) = 4;
  EXPECT_TRUE(stack.maxima(1, 62, 4.0F).empty());
}

}  // namespace
}  // namespace pelorus
