#include "services/state_machine.h"

#include <gtest/gtest.h>

namespace pelorus {
namespace {

Publication found(VisionState state) {
  Publication p;
  p.result.state = state;
  p.result.pose_valid = state != VisionState::lost;
  p.result.objects_size = 2;
  p.step = std::chrono::milliseconds(50);
  return p;
}

Publication settled(const Circumstances& circumstances, VisionState state = VisionState::tracking) {
  Publication p = found(state);
  settle_state(circumstances, p);
  return p;
}

void expect_invalid(const Publication& p, VisionState state, StateReason reason) {
  EXPECT_EQ(p.result.state, state) << to_text(p.result.state);
  EXPECT_EQ(p.reason, reason) << to_text(p.reason);
  EXPECT_FALSE(p.result.pose_valid);
  EXPECT_EQ(p.result.objects_size, 0);
  EXPECT_EQ(p.step, Duration::zero());
}

TEST(StateMachine, WithoutTroubleThePipelineSpeaks) {
  const Publication p = settled({});
  EXPECT_EQ(p.result.state, VisionState::tracking);
  EXPECT_EQ(p.reason, StateReason::none);
  EXPECT_TRUE(p.result.pose_valid);
  EXPECT_EQ(settled({}, VisionState::init).reason, StateReason::starting);
  EXPECT_EQ(settled({}, VisionState::degraded).reason, StateReason::few_points);
  Publication ambiguous;
  ambiguous.result.state = VisionState::degraded;
  ambiguous.result.world_ambiguous = true;
  settle_state({}, ambiguous);
  EXPECT_EQ(ambiguous.reason, StateReason::ambiguous_world);
}

TEST(StateMachine, WhatHasNoEstimateIsInvalid) {
  expect_invalid(settled({.standby = true}), VisionState::standby, StateReason::commanded);
  expect_invalid(settled({.pictures = false}), VisionState::camera_fault, StateReason::no_pictures);
  expect_invalid(settled({.calibration_fits = false}), VisionState::calibration_fault, StateReason::calibration);
  Circumstances frozen;
  frozen.capture.repeats = 3;
  frozen.capture.frozen = true;
  expect_invalid(settled(frozen), VisionState::camera_fault, StateReason::frozen_pictures);
  Circumstances repeated;
  repeated.capture.repeats = 1;
  expect_invalid(settled(repeated), VisionState::degraded, StateReason::repeated_picture);
  expect_invalid(settled({}, VisionState::lost), VisionState::lost, StateReason::few_points);
}

TEST(StateMachine, ExchangedSidesAreTheReasonOfALossAndOfNothingElse) {
  const Circumstances exchanged{.sides_exchanged = true};
  expect_invalid(settled(exchanged, VisionState::lost), VisionState::calibration_fault, StateReason::exchanged_sides);
  EXPECT_EQ(settled(exchanged).result.state, VisionState::tracking) << "a pose says that they are not";
  EXPECT_EQ(settled(exchanged, VisionState::init).result.state, VisionState::init);
  expect_invalid(settled({.pictures = false, .sides_exchanged = true}), VisionState::camera_fault,
                 StateReason::no_pictures);
}

TEST(StateMachine, StandbyIsStrongerThanAnyFault) {
  expect_invalid(settled({.standby = true, .calibration_fits = false, .pictures = false}), VisionState::standby,
                 StateReason::commanded);
}

TEST(StateMachine, LossesAndJumpsDegradeWithoutTakingTheEstimate) {
  Circumstances missed;
  missed.pairs_missed = 2;
  EXPECT_EQ(settled(missed).result.state, VisionState::degraded);
  EXPECT_EQ(settled(missed).reason, StateReason::pairs_dropped);
  EXPECT_TRUE(settled(missed).result.pose_valid);
  Circumstances jumped;
  jumped.capture.time_jumped = true;
  EXPECT_EQ(settled(jumped).reason, StateReason::time_jump);
}

TEST(StateMachine, LateResultsAreFlaggedAndOnlyGoodStatesChange) {
  Publication good = settled({});
  settle_late(good);
  EXPECT_TRUE(good.deadline_missed);
  EXPECT_EQ(good.result.state, VisionState::degraded);
  EXPECT_EQ(good.reason, StateReason::deadline_missed);
  Publication lost = settled({}, VisionState::lost);
  settle_late(lost);
  EXPECT_TRUE(lost.deadline_missed);
  EXPECT_EQ(lost.result.state, VisionState::lost);
}

TEST(StateMachine, OnlyUsablePairsAreWorkedOn) {
  EXPECT_TRUE(is_usable({}));
  EXPECT_FALSE(is_usable({.standby = true}));
  EXPECT_FALSE(is_usable({.calibration_fits = false}));
  EXPECT_FALSE(is_usable({.pictures = false}));
  Circumstances repeated;
  repeated.capture.repeats = 1;
  EXPECT_FALSE(is_usable(repeated));
}

}  // namespace
}  // namespace pelorus
