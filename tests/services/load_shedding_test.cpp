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
  EXPECT_EQ(shedding.choose(milliseconds(10)), Shed::object_window);
  EXPECT_EQ(shedding.choose(milliseconds(-5)), Shed::object_window);
}

// A vehicle whose steps take 25 ms with new points and 12 without, refilled in every third unless shed; one of them
// stalls. Returns the number of steps after the stall until nothing is left out any more, or -1.
int steps_to_recover(milliseconds stall, bool in_refill, milliseconds left) {
  LoadShedding shedding;
  int since_refill = 0;
  const auto step = [&](milliseconds extra) {
    const Shed shed = shedding.choose(left);
    const bool refilled = shed < Shed::refill && ++since_refill >= 3;
    if (refilled) since_refill = 0;
    shedding.learn(shed, refilled, (refilled ? milliseconds(25) : milliseconds(12)) + extra);
    return shed;
  };
  for (int k = 0; k < 300; ++k) EXPECT_EQ(step(milliseconds(0)), Shed::nothing);
  while ((since_refill == 2) != in_refill) (void)step(milliseconds(0));
  (void)step(stall);
  int last_shed = 0;
  for (int k = 1; k <= 2000; ++k) {
    if (step(milliseconds(0)) != Shed::nothing) last_shed = k;
  }
  return last_shed == 2000 ? -1 : last_shed;
}

TEST(LoadShedding, OneStallIsHeededAndForgotten) {
  for (const int stall_ms : {90, 130, 400}) {
    for (const bool in_refill : {false, true}) {
      const int steps = steps_to_recover(milliseconds(stall_ms), in_refill, milliseconds(85));
      EXPECT_GE(steps, 1) << stall_ms;
      EXPECT_LE(steps, 100) << stall_ms;
    }
  }
  EXPECT_EQ(steps_to_recover(milliseconds(20), true, milliseconds(85)), 0) << "there was time for it";
}

TEST(LoadShedding, AStepThatLeftAlmostAllOutTellsNothingOfAFullOne) {
  LoadShedding shedding = after_a_minute();
  for (int k = 0; k < 5; ++k) shedding.learn(Shed::object_window, false, milliseconds(2));
  EXPECT_EQ(shedding.choose(milliseconds(9)), Shed::object_window);
}

}  // namespace
}  // namespace pelorus
