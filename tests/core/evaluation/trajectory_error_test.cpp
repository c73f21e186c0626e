#include "core/evaluation/trajectory_error.h"

#include <gtest/gtest.h>

#include "tests/core/evaluation/hand_made_run.h"

namespace pelorus {
namespace {

using test::hand_made;
using test::rigid;

// A straight path of `count` steps of `step_m`, the estimate too long by `scale`.
std::vector<PosePair> straight(std::size_t count, double step_m, double scale) {
  std::vector<PosePair> poses;
  for (std::size_t i = 0; i <= count; ++i) {
    PosePair pose;
    pose.frame = i;
    pose.T_truth_cam.translation().z() = step_m * static_cast<double>(i);
    pose.T_world_cam.translation().z() = step_m * static_cast<double>(i) * scale;
    poses.push_back(pose);
  }
  return poses;
}

std::vector<PosePair> noisy_curve() {
  test::HandMade made = hand_made(30, 0);
  for (std::size_t i = 0; i < made.run.size(); ++i) {
    const auto phase = static_cast<double>(i);
    *made.run[i].T_world_cam = *made.run[i].T_world_cam *
                               rigid({0.01 * std::sin(phase), 0.02 * std::cos(2 * phase), 0}, {0, 0.003 * phase, 0});
  }
  return common_poses(made.run, made.truth);
}

TEST(TrajectoryError, PerfectEstimateInAnotherFrameHasNoError) {
  const test::HandMade made = hand_made(20, 0);
  const auto error = trajectory_error(common_poses(made.run, made.truth));
  ASSERT_TRUE(error);
  EXPECT_LT(error->ate_rmse_m, 1e-9);
  EXPECT_LT(error->absolute_m.max, 1e-9);
  EXPECT_LT(error->step_rad.max, 1e-7);
}

TEST(TrajectoryError, KnownScaleErrorGivesKnownStepAndDrift) {
  const auto error = trajectory_error(straight(40, 0.5, 1.02));
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->path_length_m, 20, 1e-9);
  EXPECT_NEAR(error->step_m.mean, 0.01, 1e-12);
  EXPECT_NEAR(error->step_m.rmse, 0.01, 1e-12);
  EXPECT_NEAR(error->final_drift_m, 0.4, 1e-9);
  EXPECT_NEAR(error->final_drift_percent.value(), 2.0, 1e-9);
  EXPECT_NEAR(error->absolute_m.mean, 0.01 * 41 / 2, 1e-9);
  EXPECT_FALSE(error->kitti) << "no sub-path of 100 m exists";
}

TEST(TrajectoryError, APathTooShortToDivideByHasNoShareOfIt) {
  const auto error = trajectory_error(straight(4, 0.1, 1.02));
  ASSERT_TRUE(error);
  EXPECT_GT(error->final_drift_m, 0);
  EXPECT_FALSE(error->final_drift_percent);
}

TEST(TrajectoryError, SubPathsOfAScaledPathDriftByTheScale) {
  const auto error = trajectory_error(straight(300, 1.0, 1.02));
  ASSERT_TRUE(error && error->kitti);
  EXPECT_NEAR(error->kitti->translation_percent, 2.0, 1e-9);
  EXPECT_NEAR(error->kitti->rotation_deg_per_100m, 0, 1e-5);
  EXPECT_EQ(error->kitti->count, 21U + 11U + 1U);  // starts every 10 frames: 100 m, 200 m, 300 m
}

TEST(TrajectoryError, KnownRotationPerStepIsReportedAsRotation) {
  std::vector<PosePair> poses = straight(10, 0.1, 1.0);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].T_world_cam.linear() = so3_exp({0, 0, 0.002 * static_cast<double>(i)});
  }
  const auto error = trajectory_error(poses);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->step_rad.mean, 0.002, 1e-9);
  EXPECT_NEAR(error->final_drift_rad, 0.02, 1e-9);
}

TEST(TrajectoryError, DoesNotChangeWhenBothSidesMoveRigidly) {
  std::vector<PosePair> poses = noisy_curve();
  const auto before = trajectory_error(poses);
  for (PosePair& pose : poses) {
    pose.T_world_cam = rigid({5, 1, -3}, {0.4, -1.0, 0.2}) * pose.T_world_cam;
    pose.T_truth_cam = rigid({-1, 7, 2}, {1.2, 0.1, 0.5}) * pose.T_truth_cam;
  }
  const auto after = trajectory_error(poses);
  ASSERT_TRUE(before && after);
  EXPECT_GT(before->ate_rmse_m, 0.01);
  EXPECT_NEAR(before->ate_rmse_m, after->ate_rmse_m, 1e-9);
  EXPECT_NEAR(before->absolute_m.mean, after->absolute_m.mean, 1e-9);
  EXPECT_NEAR(before->step_m.rmse, after->step_m.rmse, 1e-9);
}

// Zigzag of +-d beside a straight line: the best fit is the line itself, so ATE is d.
TEST(TrajectoryError, AlignedErrorOfAZigzagIsItsAmplitude) {
  std::vector<PosePair> poses = straight(1000, 0.1, 1.0);
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].T_world_cam.translation().x() = i % 2 == 0 ? 0.03 : -0.03;
  const auto error = trajectory_error(poses);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->ate_rmse_m, 0.03, 1e-4);
}

TEST(TrajectoryError, MirroredPathIsNotAlignedAway) {
  std::vector<PosePair> poses = noisy_curve();
  for (PosePair& pose : poses) {
    const double x = pose.T_world_cam.translation().x();
    pose.T_world_cam.translation().y() = 3 * x * x;
    pose.T_world_cam.translation().z() = 4 * x * x * x;
    pose.T_truth_cam = pose.T_world_cam;
    pose.T_truth_cam.translation().x() = -x;
  }
  EXPECT_GT(trajectory_error(poses)->ate_rmse_m, 0.01);
}

TEST(TrajectoryError, StepOverAFrameWithoutPoseIsNotCounted) {
  test::HandMade made = hand_made(10, 0);
  made.run[5].T_world_cam.reset();
  const auto error = trajectory_error(common_poses(made.run, made.truth));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->poses, 9U);
  EXPECT_EQ(error->step_m.count, 7U);
}

TEST(TrajectoryError, OnePoseIsNoTrajectory) {
  EXPECT_FALSE(trajectory_error(straight(0, 1, 1)));
  EXPECT_FALSE(first_pose_alignment({}));
}

TEST(ErrorStatistics, KnownListGivesKnownStatistics) {
  const ErrorStatistics statistics = summarize({4, 1, 1, 2});
  EXPECT_EQ(statistics.count, 4U);
  EXPECT_DOUBLE_EQ(statistics.mean, 2);
  EXPECT_DOUBLE_EQ(statistics.median, 1.5);
  EXPECT_DOUBLE_EQ(statistics.rmse, std::sqrt(22.0 / 4));
  EXPECT_DOUBLE_EQ(statistics.max, 4);
  EXPECT_EQ(summarize({}).count, 0U);
}

}  // namespace
}  // namespace pelorus
