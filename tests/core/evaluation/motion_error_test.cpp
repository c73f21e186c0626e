#include "core/evaluation/motion_error.h"

#include <gtest/gtest.h>

#include "tests/core/evaluation/hand_made_run.h"

namespace pelorus {
namespace {

using test::hand_made;
using test::HandMade;
using test::rigid;

constexpr std::size_t kFrames = 20;

MotionError error_of(const HandMade& made, int body = 0) {
  return motion_error(made.run, made.truth, associate(made.run, made.truth, {}), body, test::T_truth_world());
}

TEST(MotionError, PerfectEstimateHasNoErrorWhereverItPutsTheObjectsOrigin) {
  HandMade made = hand_made(kFrames, 2);
  for (EstimatedFrame& frame : made.run) {
    for (EstimatedObject& object : frame.objects)
      object.T_world_obj = object.T_world_obj * rigid({9, -3, 2}, {1, 2, 0});
  }
  const MotionError error = error_of(made, 1);
  EXPECT_EQ(error.step_m.count, kFrames - 1);
  EXPECT_LT(error.step_m.max, 1e-9);
  EXPECT_LT(error.since_birth_m.max, 1e-9);
  EXPECT_LT(error.since_birth_rad.max, 1e-7);
}

TEST(MotionError, KnownTranslationErrorIsFoundWhole) {
  HandMade made = hand_made(kFrames, 1);
  for (EstimatedFrame& frame : made.run) {
    frame.objects[0].M_world = rigid({0.003, 0, 0.004}, {0, 0, 0}) * frame.objects[0].M_world;
  }
  const MotionError error = error_of(made);
  EXPECT_NEAR(error.step_m.median, 0.005, 1e-12);
  EXPECT_NEAR(error.step_m.rmse, 0.005, 1e-12);
  EXPECT_LT(error.step_rad.max, 1e-7);
}

TEST(MotionError, RotationErrorAboutTheTrueCentreMovesNothing) {
  HandMade made = hand_made(kFrames, 1);
  for (std::size_t i = 1; i < kFrames; ++i) {
    const Eigen::Vector3d centre = test::T_world_body_at(0, i).translation();
    const Rigid3 T_world_centre = rigid(centre, {0, 0, 0});
    made.object(i, 0).M_world =
        T_world_centre * rigid({0, 0, 0}, {0, 0.01, 0}) * T_world_centre.inverse() * made.object(i, 0).M_world;
  }
  const MotionError error = error_of(made);
  EXPECT_LT(error.step_m.max, 1e-9);
  EXPECT_NEAR(error.step_rad.mean, 0.01, 1e-9);
}

// The same rotation error about the world's origin carries the body's centre with it: distance times angle.
TEST(MotionError, RotationErrorAboutAnotherPointMovesTheCentreByItsLever) {
  HandMade made = hand_made(2, 1);
  made.object(1, 0).M_world = rigid({0, 0, 0}, {0, 1e-4, 0}) * made.object(1, 0).M_world;
  const Eigen::Vector3d centre = test::T_world_body_at(0, 1).translation();
  const double lever_m = std::hypot(centre.x(), centre.z());
  EXPECT_NEAR(error_of(made).step_m.mean, lever_m * 1e-4, 1e-8);
}

TEST(MotionError, SteadyStepErrorAddsUpSinceBirth) {
  HandMade made = hand_made(kFrames, 1);
  for (std::size_t i = 0; i < kFrames; ++i) {
    made.object(i, 0).T_world_obj.translation().x() += 0.002 * static_cast<double>(i);
  }
  const MotionError error = error_of(made);
  EXPECT_NEAR(error.since_birth_m.max, 0.002 * (kFrames - 1), 1e-9);
  EXPECT_NEAR(error.since_birth_m.mean, 0.002 * kFrames / 2, 1e-9);
  EXPECT_LT(error.step_m.max, 1e-9);
}

TEST(MotionError, CoastingFramesAreNotMeasurements) {
  HandMade made = hand_made(kFrames, 1);
  made.object(7, 0).phase = ObjectPhase::coasting;
  made.object(7, 0).M_world = rigid({5, 5, 5}, {1, 1, 1});
  const MotionError error = error_of(made);
  EXPECT_EQ(error.step_m.count, kFrames - 2);
  EXPECT_LT(error.step_m.max, 1e-9);
}

TEST(MotionError, BodyWithoutAMatchHasNoErrorsToCount) {
  HandMade made = hand_made(kFrames, 2);
  for (EstimatedFrame& frame : made.run) frame.objects.pop_back();
  EXPECT_EQ(error_of(made, 1).step_m.count, 0U);
}

}  // namespace
}  // namespace pelorus
