#include "core/base/spsc_ring.h"

#include <gtest/gtest.h>

#include <thread>

namespace pelorus {
namespace {

TEST(SpscRing, HoldsItsCapacityAndRefusesMore) {
  SpscRing<int> ring(3);
  EXPECT_TRUE(ring.empty());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(ring.try_push(i));
  EXPECT_FALSE(ring.try_push(3));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ring.try_pop(), i);
  EXPECT_EQ(ring.try_pop(), std::nullopt);
}

TEST(SpscRing, KeepsOrderAcrossManyTurns) {
  SpscRing<int> ring(2);
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(ring.try_push(i));
    ASSERT_EQ(ring.try_pop(), i);
  }
}

TEST(SpscRing, LosesAndRepeatsNothingBetweenThreads) {
  SpscRing<int> ring(5);
  constexpr int kCount = 200'000;
  std::jthread producer([&] {
    for (int i = 0; i < kCount;) i += ring.try_push(i) ? 1 : 0;
  });
  for (int expected = 0; expected < kCount;) {
    const std::optional<int> got = ring.try_pop();
    if (!got) continue;
    ASSERT_EQ(*got, expected);
    ++expected;
  }
}

}  // namespace
}  // namespace pelorus
