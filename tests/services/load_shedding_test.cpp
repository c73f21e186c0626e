#include "services/load_shedding.h"

#include <gtest/gtest.h>

#include <chrono>

namespace pelorus {
namespace {

using std::chrono::milliseconds;

LoadShedding after_a_minute() {
  LoadShedding shedding;
  for (int k = 0; k < 600; ++k) {
    const bool refilled = k % 3 == 0;
    shedding.learn(Shed::nothing, refilled, refilled ? milliseconds(20) : milliseconds(10));
  }
  return shedding;
}

TEST(LoadShedding, NothingIsLeftOutBeforeAnythingIsKnownOrWhileThereIsTime) {
  EXPECT_EQ(LoadShedding().choose(milliseconds(1)), Shed::nothing);
  EXPECT_EQ(after_a_minute().choose(milliseconds(80)), Shed::nothing);
  EXPECT_EQ(after_a_minute().choose(milliseconds(23)), Shed::nothing);
}

TEST(LoadShedding, TheShorterTheTimeTheMoreIsLeftOut) {
  const LoadShedding shedding = after_a_minute();
  EXPECT_EQ(shedding.choose(milliseconds(21)), Shed::refill);
  EXPECT_EQ(shedding.choose(milliseconds(12)), Shed::refill);
  EXPECT_EQ(shedding.choose(milliseconds(10)), Shed::refinement);
  EXPECT_EQ(shedding.choose(milliseconds(6)), Shed::object_window);
  EXPECT_EQ(shedding.choose(milliseconds(-5)), Shed::object_window);
}

TEST(LoadShedding, APeakIsHeededAndFades) {
  LoadShedding shedding = after_a_minute();
  shedding.learn(Shed::nothing, true, milliseconds(60));
  EXPECT_EQ(shedding.choose(milliseconds(50)), Shed::refill);
  for (int k = 0; k < 200; ++k) shedding.learn(Shed::nothing, true, milliseconds(20));
  EXPECT_EQ(shedding.choose(milliseconds(50)), Shed::nothing);
}

TEST(LoadShedding, AStepThatLeftAlmostAllOutTellsNothingOfAFullOne) {
  LoadShedding shedding = after_a_minute();
  for (int k = 0; k < 600; ++k) shedding.learn(Shed::object_window, false, milliseconds(2));
  EXPECT_EQ(shedding.choose(milliseconds(10)), Shed::refinement);
}

}  // namespace
}  // namespace pelorus
