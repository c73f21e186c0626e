#include "core/evaluation/tracking_score.h"

#include <gtest/gtest.h>

#include "tests/core/evaluation/hand_made_run.h"

namespace pelorus {
namespace {

using test::hand_made;
using test::HandMade;

TrackingScore score_of(const HandMade& made) {
  return tracking_score(made.run, made.truth, associate(made.run, made.truth, {}), {});
}

void hide(HandMade& made, std::size_t from, std::size_t to) {
  for (std::size_t i = from; i < to; ++i) {
    made.body(i, 0).visible_px = 0;
    made.object(i, 0).phase = ObjectPhase::coasting;
  }
}

TEST(TrackingScore, PerfectRunIsPerfect) {
  const TrackingScore score = score_of(hand_made(21, 2));
  ASSERT_EQ(score.bodies.size(), 2U);
  EXPECT_EQ(score.bodies[1].frames_on_show, 20U) << "no motion has happened in frame 0";
  EXPECT_DOUBLE_EQ(score.bodies[1].coverage(), 1);
  EXPECT_EQ(score.bodies[1].identity_switches, 0);
  EXPECT_DOUBLE_EQ(score.bodies[1].time_to_detection_s.value(), 0);
  EXPECT_DOUBLE_EQ(score.right_count_share.value(), 1);
  EXPECT_TRUE(score.false_objects.empty());
}

TEST(TrackingScore, LateConfirmationCostsCoverageAndTime) {
  HandMade made = hand_made(21, 1);
  for (std::size_t i = 0; i < 6; ++i) made.object(i, 0).phase = ObjectPhase::tentative;
  const TrackingScore score = score_of(made);
  EXPECT_DOUBLE_EQ(score.bodies[0].coverage(), 15.0 / 20);
  EXPECT_NEAR(score.bodies[0].time_to_detection_s.value(), 0.5, 1e-9);
  EXPECT_DOUBLE_EQ(score.right_count_share.value(), 15.0 / 20);
  EXPECT_DOUBLE_EQ(score.right_count_settled_share.value(), 1) << "half a second is within the settling time";
}

TEST(TrackingScore, BodyNeverDetectedHasNoTimeToDetection) {
  HandMade made = hand_made(10, 1);
  for (EstimatedFrame& frame : made.run) frame.objects.clear();
  const TrackingScore score = score_of(made);
  EXPECT_FALSE(score.bodies[0].time_to_detection_s);
  EXPECT_DOUBLE_EQ(score.bodies[0].coverage(), 0);
  EXPECT_DOUBLE_EQ(score.right_count_share.value(), 0);
}

TEST(TrackingScore, NewIdOnTheSameBodyIsASwitch) {
  HandMade made = hand_made(20, 1);
  for (std::size_t i = 10; i < 20; ++i) made.object(i, 0).id = BodyId{7};
  EXPECT_EQ(score_of(made).bodies[0].identity_switches, 1);
  EXPECT_EQ(score_of(made).bodies[0].ids.size(), 2U);
}

TEST(TrackingScore, AShareOfNoFramesIsUnknown) {
  HandMade made = hand_made(6, 1);  // half a second: the body has not settled
  const TrackingScore score = score_of(made);
  EXPECT_TRUE(score.right_count_share);
  EXPECT_FALSE(score.right_count_settled_share);
  made.run.resize(1);
  made.truth.frames.resize(1);
  EXPECT_FALSE(score_of(made).right_count_share) << "no motion has happened yet";
}

TEST(TrackingScore, NewIdAfterMoreThanTwoSecondsOutOfViewIsForgiven) {
  HandMade made = hand_made(60, 1);
  hide(made, 10, 35);
  for (std::size_t i = 35; i < 60; ++i) made.object(i, 0).id = BodyId{7};
  EXPECT_EQ(score_of(made).bodies[0].identity_switches, 0);
  EXPECT_EQ(score_of(made).bodies[0].frames_on_show, 34U);
}

TEST(TrackingScore, NewIdAfterAShortOcclusionIsASwitch) {
  HandMade made = hand_made(60, 1);
  hide(made, 10, 25);
  for (std::size_t i = 25; i < 60; ++i) made.object(i, 0).id = BodyId{7};
  EXPECT_EQ(score_of(made).bodies[0].identity_switches, 1);
}

TEST(TrackingScore, TwoObjectsThatSwapBodiesAreTwoSwitches) {
  HandMade made = hand_made(20, 2);
  for (std::size_t i = 10; i < 20; ++i) std::swap(made.object(i, 0).id, made.object(i, 1).id);
  const TrackingScore score = score_of(made);
  EXPECT_EQ(score.bodies[0].identity_switches + score.bodies[1].identity_switches, 2);
}

TEST(TrackingScore, ObjectFarFromEveryBodyIsFalse) {
  HandMade made = hand_made(20, 1);
  for (EstimatedFrame& frame : made.run) {
    EstimatedObject ghost = frame.objects[0];
    ghost.id = BodyId{5};
    ghost.centroid_world.z() += 3;
    frame.objects.push_back(ghost);
  }
  const TrackingScore score = score_of(made);
  ASSERT_EQ(score.false_objects.size(), 1U);
  EXPECT_EQ(score.false_objects[0].id.value, 5);
  EXPECT_EQ(score.false_objects[0].frames, 20U);
  EXPECT_FALSE(score.false_objects[0].duplicate);
  EXPECT_DOUBLE_EQ(score.false_per_1000_frames, 50);
  EXPECT_DOUBLE_EQ(score.right_count_share.value(), 0);
}

TEST(TrackingScore, ObjectOnABodyThatNeverMovesIsFalseAndNamesIt) {
  HandMade made = hand_made(20, 1);
  made.truth.bodies[0] = "parked";
  for (TrueFrame& frame : made.truth.frames) frame.bodies[0].moving = false;
  const TrackingScore score = score_of(made);
  ASSERT_EQ(score.false_objects.size(), 1U);
  EXPECT_EQ(score.false_objects[0].resting_body, "parked");
  EXPECT_EQ(score.bodies[0].frames_on_show, 0U);
}

TEST(TrackingScore, SecondObjectOnOneBodyIsAFalseDuplicate) {
  HandMade made = hand_made(20, 1);
  for (EstimatedFrame& frame : made.run) {
    EstimatedObject second = frame.objects[0];
    second.id = BodyId{2};
    second.centroid_world.x() += 0.2;
    frame.objects.push_back(second);
  }
  const TrackingScore score = score_of(made);
  ASSERT_EQ(score.false_objects.size(), 1U);
  EXPECT_TRUE(score.false_objects[0].duplicate);
}

TEST(TrackingScore, ObjectKeptThroughAStopOfItsBodyIsNotHeldAgainstIt) {
  HandMade made = hand_made(20, 1);
  for (std::size_t i = 10; i < 15; ++i) made.body(i, 0).moving = false;
  const TrackingScore score = score_of(made);
  EXPECT_DOUBLE_EQ(score.right_count_share.value(), 1);
  EXPECT_EQ(score.bodies[0].frames_on_show, 14U);
  EXPECT_TRUE(score.false_objects.empty());
}

TEST(TrackingScore, BodyHardlySeenIsNotDemanded) {
  HandMade made = hand_made(20, 1);
  for (std::size_t i = 10; i < 20; ++i) {
    made.body(i, 0).visible_px = 400;
    made.run[i].objects.clear();
  }
  const TrackingScore score = score_of(made);
  EXPECT_DOUBLE_EQ(score.bodies[0].coverage(), 1);
  EXPECT_DOUBLE_EQ(score.right_count_share.value(), 1);
}

TEST(TrackingScore, FrameWithoutPoseIsNotARightCount) {
  HandMade made = hand_made(11, 0);
  made.run[5].T_world_cam.reset();
  EXPECT_DOUBLE_EQ(score_of(made).right_count_share.value(), 0.9);
}

}  // namespace
}  // namespace pelorus
