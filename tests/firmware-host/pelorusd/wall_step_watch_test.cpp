#include "firmware-host/pelorusd/wall_step_watch.h"

#include <gtest/gtest.h>

#include <chrono>

namespace pelorus {
namespace {

using namespace std::chrono_literals;

TEST(WallStepWatch, AClockThatWasSetIsToldOnceWithTheCure) {
  for (const Duration step : {Duration(3600s), Duration(-3600s)}) {
    WallStepWatch watch;
    EXPECT_FALSE(watch.look(0ns));
    const std::optional<std::string> told = watch.look(step);
    ASSERT_TRUE(told);
    EXPECT_NE(told->find(step > 0ns ? "by +3600.000 s" : "by -3600.000 s"), std::string::npos) << *told;
    EXPECT_NE(told->find("restart the service"), std::string::npos) << *told;
    EXPECT_FALSE(watch.look(step));
  }
}

TEST(WallStepWatch, WhatClocksAreCorrectedByUnderWayIsNotTold) {
  WallStepWatch watch;
  for (const Duration step : {0ms, 20ms, -20ms, 100ms, -100ms}) EXPECT_FALSE(watch.look(step));
  EXPECT_TRUE(watch.look(101ms));
}

}  // namespace
}  // namespace pelorus
