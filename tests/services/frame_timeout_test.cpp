#include "services/frame_timeout.h"

#include <gtest/gtest.h>

#include <chrono>

namespace pelorus {
namespace {

using namespace std::chrono_literals;

void feed(FrameTimeout& timeout, int pairs, Duration period, Timestamp& time) {
  for (int i = 0; i < pairs; ++i) timeout.learn(time = time + period, 1);
}

TEST(FrameTimeout, IsThreeAndAHalfPeriodsOfTheRateAtWhichPairsCome) {
  for (const Duration period : {500ms, 100ms, 50ms, 33ms}) {
    FrameTimeout timeout(0);
    Timestamp time{1'000'000'000};
    feed(timeout, 4, period, time);
    EXPECT_EQ(timeout.value(), 7 * period / 2);
  }
}

TEST(FrameTimeout, WaitsHalfASecondUntilTheRateIsKnown) {
  FrameTimeout timeout(0);
  Timestamp time;
  EXPECT_EQ(timeout.value(), 500ms);
  feed(timeout, 3, 10ms, time);
  EXPECT_EQ(timeout.value(), 500ms) << "two intervals are no rate";
}

TEST(FrameTimeout, LostPairsAndSpellsDoNotMoveIt) {
  FrameTimeout timeout(0);
  Timestamp time;
  feed(timeout, 9, 50ms, time);
  timeout.learn(time = time + 250ms, 5);  // four were lost on the way
  EXPECT_EQ(timeout.value(), 175ms);
  timeout.learn(time = time + 10s, 1);  // the camera was away and counts anew
  timeout.learn(time = time + 1ms, 1);  // a stamp that jumped
  EXPECT_EQ(timeout.value(), 175ms);
}

TEST(FrameTimeout, FollowsANewRate) {
  FrameTimeout timeout(0);
  Timestamp time;
  feed(timeout, 20, 50ms, time);
  feed(timeout, 9, 100ms, time);
  EXPECT_EQ(timeout.value(), 350ms);
}

TEST(FrameTimeout, IsNeverShorterThanASchedulerMayTake) {
  FrameTimeout timeout(0);
  Timestamp time;
  feed(timeout, 9, 5ms, time);
  EXPECT_EQ(timeout.value(), 60ms);
}

TEST(FrameTimeout, WhatIsGivenStays) {
  FrameTimeout timeout(70);
  Timestamp time;
  feed(timeout, 9, 50ms, time);
  EXPECT_EQ(timeout.value(), 70ms);
}

}  // namespace
}  // namespace pelorus
