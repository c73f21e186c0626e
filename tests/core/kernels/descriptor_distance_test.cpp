#include "core/kernels/descriptor_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/kernels/each_target.h"

namespace pelorus {
namespace {

TEST(DescriptorDistance, VectorPathsEqualTheReferenceBitByBitAndTheSumOfSquares) {
  for_each_target([] {
    std::mt19937 rng(1);
    std::normal_distribution<float> gauss;
    DescriptorBlock block;
    std::array<std::array<float, 64>, kBlockDescriptors> candidates{};
    for (std::size_t i = 0; i < kBlockDescriptors; ++i) {
      for (float& x : candidates[i]) x = gauss(rng);
      block.set(i, candidates[i]);
    }
    std::array<float, 64> query{};
    for (float& x : query) x = gauss(rng);
    BlockDistances distances{};
    BlockDistances expected{};
    squared_distances(query, block, distances);
    reference::squared_distances(query, block, expected);
    EXPECT_EQ(distances, expected);
    for (std::size_t i = 0; i < kBlockDescriptors; ++i) {
      double exact = 0;
      for (std::size_t k = 0; k < 64; ++k) {
        exact += std::pow(static_cast<double>(query[k]) - static_cast<double>(candidates[i][k]), 2);
      }
      EXPECT_NEAR(static_cast<double>(distances[i]), exact, 1e-4 * exact);
    }
  });
}

}  // namespace
}  // namespace pelorus
