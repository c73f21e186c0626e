#include "core/kernels/descriptor_distance.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/core/kernels/each_target.h"

namespace pelorus {
namespace {

TEST(DescriptorDistance, VectorPathsEqualTheReferenceBitByBit) {
  for_each_target([] {
    std::mt19937 rng(1);
    std::normal_distribution<float> gauss;
    for (int k = 0; k < 100; ++k) {
      std::array<float, 64> a{};
      std::array<float, 64> b{};
      double exact = 0;
      for (std::size_t i = 0; i < 64; ++i) {
        a[i] = gauss(rng), b[i] = gauss(rng);
        exact += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
      }
      EXPECT_EQ(squared_distance(a, b), reference::squared_distance(a, b));
      EXPECT_NEAR(static_cast<double>(squared_distance(a, b)), exact, 1e-4 * exact);
    }
  });
}

}  // namespace
}  // namespace pelorus
