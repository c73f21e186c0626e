#include "services/side_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

namespace pelorus {
namespace {

struct Counted {
  int sum = 0;  // plain: the hand-over itself has to order the accesses
  int step = 1;
  std::thread::id by;
  void add() {
    sum += step;
    by = std::this_thread::get_id();
  }
};

TEST(SideThread, DoesEachPieceOnceOnItsOwnThreadAndTheWaiterSeesIt) {
  SideThread worker;
  Counted counted;
  for (int k = 1; k <= 20000; ++k) {
    counted.step = k;
    worker.start(work_of<&Counted::add>(counted));
    worker.wait();
    ASSERT_EQ(counted.sum, k * (k + 1) / 2);
  }
  EXPECT_NE(counted.by, std::this_thread::get_id());
  EXPECT_NE(counted.by, std::thread::id());
}

struct Held {
  std::atomic<bool> go{false};
  std::atomic<bool> ended{false};
  void hold() {
    while (!go.load()) std::this_thread::yield();
    ended.store(true);
  }
};

TEST(SideThread, StartReturnsAtOnceAndDoneTellsTheEnd) {
  SideThread worker;
  EXPECT_TRUE(worker.done());
  Held held;
  worker.start(work_of<&Held::hold>(held));
  EXPECT_FALSE(worker.done());
  EXPECT_FALSE(held.ended.load());
  held.go = true;
  worker.wait();
  EXPECT_TRUE(worker.done());
  EXPECT_TRUE(held.ended.load());
}

TEST(SideThread, AWaiterThatSleepsIsWoken) {
  SideThread worker;
  struct Slow {
    void run() { std::this_thread::sleep_for(std::chrono::milliseconds(30)); }
  } slow;
  for (int k = 0; k < 3; ++k) {
    worker.start(work_of<&Slow::run>(slow));
    worker.wait();
    EXPECT_TRUE(worker.done());
  }
}

TEST(SideThread, EndsWithItsWorkDone) {
  Held held;
  held.go = true;
  {
    SideThread worker;
    worker.start(work_of<&Held::hold>(held));
  }
  EXPECT_TRUE(held.ended.load());
}

TEST(SideThreadDeathTest, ASecondPieceBeforeTheFirstIsDoneIsAMistake) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        SideThread worker;
        Held held;
        worker.start(work_of<&Held::hold>(held));
        worker.start(work_of<&Held::hold>(held));
      },
      "one piece of work at a time");
}

}  // namespace
}  // namespace pelorus
