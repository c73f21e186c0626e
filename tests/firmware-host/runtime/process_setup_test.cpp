#include "firmware-host/runtime/process_setup.h"

#include <gtest/gtest.h>

#include <array>

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

TEST(BindingOrder, OfThisMachineWrapsAround) {
  const int last = processor_to_bind(0);
  ASSERT_GE(last, 0);
  int n = 1;
  while (n < 4096 && processor_to_bind(n) != last) ++n;
  EXPECT_LT(n, 4096);
}

}  // namespace
}  // namespace pelorus
