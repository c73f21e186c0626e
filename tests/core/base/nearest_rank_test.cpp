#include "core/base/nearest_rank.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace pelorus {
namespace {

std::vector<double> one_to(int count) {
  std::vector<double> values(static_cast<std::size_t>(count));
  std::iota(values.begin(), values.end(), 1.0);
  return values;
}

TEST(NearestRank, IsTheLeastValueThatTheShareDoesNotExceed) {
  const std::vector<double> values = one_to(1000);
  EXPECT_EQ(nearest_rank(values, 0.5), 500);
  EXPECT_EQ(nearest_rank(values, 0.99), 990);
  EXPECT_EQ(nearest_rank(values, 0.9901), 991);
  EXPECT_EQ(nearest_rank(values, 0.999), 999);
}

TEST(NearestRank, OfFewValuesAHighShareIsTheGreatest) { EXPECT_EQ(nearest_rank(one_to(90), 0.99), 90); }

TEST(NearestRank, EndsAreTheLeastAndTheGreatest) {
  EXPECT_EQ(nearest_rank(one_to(7), 0), 1);
  EXPECT_EQ(nearest_rank(one_to(7), 1), 7);
  EXPECT_EQ(nearest_rank(one_to(1), 0.5), 1);
}

TEST(NearestRank, OfNothingIsNotANumber) { EXPECT_TRUE(std::isnan(nearest_rank({}, 0.5))); }

}  // namespace
}  // namespace pelorus
