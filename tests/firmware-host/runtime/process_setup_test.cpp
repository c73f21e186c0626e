#include "firmware-host/runtime/process_setup.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <array>
#include <set>

namespace pelorus {
namespace {

using Order = std::vector<int>;

TEST(BindingOrder, ThreadsThatComputeSideBySideGetCoresOfTheirOwn) {
  constexpr std::array processors{0, 1, 2, 3};
  EXPECT_EQ(binding_order(processors, [](int p) { return p; }), (Order{3, 2, 1, 0}));
  EXPECT_EQ(binding_order(processors, [](int p) { return p / 2; }), (Order{3, 1, 2, 0})) << "neighbours share a core";
  EXPECT_EQ(binding_order(processors, [](int p) { return p % 2; }), (Order{3, 2, 1, 0})) << "halves share cores";
  EXPECT_EQ(binding_order(processors, [](int) { return 0; }), (Order{3, 2, 1, 0})) << "one core";
}

TEST(BindingOrder, OnlyProcessorsThatMayBeUsedAreNamed) {
  constexpr std::array processors{1, 4, 5};
  EXPECT_EQ(binding_order(processors, [](int p) { return p & ~1; }), (Order{5, 1, 4}));
}

TEST(BindingOrder, OfThisMachineTakesEachProcessorOnceAndThenWrapsAround) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  ASSERT_EQ(::sched_getaffinity(0, sizeof allowed, &allowed), 0);
  const int count = CPU_COUNT(&allowed);
  std::set<int> bound;
  for (int n = 0; n < count; ++n) {
    bound.insert(processor_to_bind(n));
    EXPECT_EQ(processor_to_bind(n + count), processor_to_bind(n));
  }
  EXPECT_EQ(bound.size(), static_cast<std::size_t>(count));
  for (const int processor : bound) EXPECT_TRUE(processor >= 0 && CPU_ISSET(processor, &allowed)) << processor;
}

}  // namespace
}  // namespace pelorus
