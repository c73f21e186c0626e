#include "core/evaluation/association.h"

#include <gtest/gtest.h>

#include "tests/core/evaluation/hand_made_run.h"

namespace pelorus {
namespace {

using test::hand_made;
using test::HandMade;
using test::rigid;

std::vector<FrameMatches> matches_of(const HandMade& made) { return associate(made.run, made.truth, {}); }

TEST(Association, EachObjectFindsItsOwnBodyInEveryFrame) {
  const HandMade made = hand_made(10, 3);
  for (const FrameMatches& frame : matches_of(made)) {
    ASSERT_EQ(frame.pairs.size(), 3U);
    for (int body = 0; body < 3; ++body) EXPECT_EQ(frame.of_body(body)->object.value, body + 1);
    EXPECT_TRUE(frame.duplicates.empty());
  }
}

TEST(Association, ObjectBeyondTheGateMatchesNothing) {
  HandMade made = hand_made(1, 1);
  made.object(0, 0).centroid_world.x() += 0.7;
  EXPECT_TRUE(matches_of(made)[0].pairs.empty());
}

TEST(Association, TentativeAndEndedObjectsClaimNothing) {
  for (const ObjectPhase phase : {ObjectPhase::tentative, ObjectPhase::ended}) {
    HandMade made = hand_made(1, 1);
    made.object(0, 0).phase = phase;
    EXPECT_TRUE(matches_of(made)[0].pairs.empty()) << to_text(phase);
  }
}

TEST(Association, DriftOfTheCameraPoseDoesNotMatter) {
  HandMade made = hand_made(10, 2);
  const Rigid3 T_drifted_world = rigid({30, -20, 5}, {0.5, 0, 1});
  made.run[9].T_world_cam = T_drifted_world * *made.run[9].T_world_cam;
  for (EstimatedObject& object : made.run[9].objects) object.centroid_world = T_drifted_world * object.centroid_world;
  EXPECT_EQ(matches_of(made)[9].pairs.size(), 2U);
}

TEST(Association, PairIsKeptWhenAnotherObjectComesNearer) {
  HandMade made = hand_made(2, 1);
  EstimatedObject intruder = made.object(1, 0);
  intruder.id = BodyId{9};
  intruder.centroid_world = test::T_world_body_at(0, 1).translation();
  made.run[1].objects.insert(made.run[1].objects.begin(), intruder);
  const FrameMatches matches = matches_of(made)[1];
  EXPECT_EQ(matches.of_body(0)->object.value, 1);
  ASSERT_EQ(matches.duplicates.size(), 1U);
  EXPECT_EQ(matches.duplicates[0].object.value, 9);
}

TEST(Association, NearestPairGoesFirstWhenNothingWasPairedBefore) {
  HandMade made = hand_made(1, 1);
  EstimatedObject nearer = made.object(0, 0);
  nearer.id = BodyId{9};
  nearer.centroid_world = test::T_world_body_at(0, 0).translation();
  made.run[0].objects.push_back(nearer);
  EXPECT_EQ(matches_of(made)[0].of_body(0)->object.value, 9);
}

TEST(Association, KnownBoxCountsFromItsSurface) {
  HandMade made = hand_made(1, 1);
  made.body(0, 0).half_size_m = Eigen::Vector3d(2, 1, 1);
  made.object(0, 0).centroid_world = test::T_world_body_at(0, 0) * Eigen::Vector3d(2.1, 0, 0);
  EXPECT_EQ(matches_of(made)[0].pairs.size(), 1U) << "0.1 m from the box, 2.1 m from the centre";
  made.object(0, 0).centroid_world = test::T_world_body_at(0, 0) * Eigen::Vector3d(0, 1.4, 0);
  EXPECT_TRUE(matches_of(made)[0].pairs.empty()) << "0.4 m from the box";
  made.truth.exact = false;
  EXPECT_EQ(matches_of(made)[0].pairs.size(), 1U) << "a box drawn by hand is given 0.5 m";
}

TEST(Association, ObjectWithinTwoBoxesIsTheOneWhoseCentreIsNearer) {
  HandMade made = hand_made(1, 2);
  for (int body = 0; body < 2; ++body) made.body(0, body).half_size_m = Eigen::Vector3d(2, 2, 2);
  made.run[0].objects.pop_back();
  made.object(0, 0).centroid_world = test::T_world_body_at(1, 0) * Eigen::Vector3d(-0.9, 0, 0);
  ASSERT_EQ(matches_of(made)[0].pairs.size(), 1U);
  EXPECT_EQ(matches_of(made)[0].pairs[0].body, 1);
}

TEST(Association, FrameWithoutPoseHasNoMatches) {
  HandMade made = hand_made(1, 1);
  made.run[0].T_world_cam.reset();
  EXPECT_TRUE(matches_of(made)[0].pairs.empty());
}

}  // namespace
}  // namespace pelorus
