#include "services/body_estimate.h"

#include <gtest/gtest.h>

namespace pelorus {
namespace {

// A camera that looks straight down, its upper image edge forward: image right is starboard, image down is aft.
Rigid3 looking_down() {
  Rigid3 T_body_cam = Rigid3::Identity();
  T_body_cam.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  T_body_cam.translation() << 0.4, 0.1, 0.2;
  return T_body_cam;
}

FrameResult moved(const Rigid3& T_prev_curr_body, const BodyFrames& frames) {
  const Rigid3& T_bc = frames.T_body_cam();
  FrameResult result;
  result.pose_valid = true;
  result.T_curr_prev = (T_bc.inverse() * T_prev_curr_body * T_bc).inverse();
  result.T_world_cam = T_bc.inverse() * T_prev_curr_body * T_bc;
  result.cov_T_curr_prev = 1e-6 * Matrix6d::Identity();
  return result;
}

TEST(BodyEstimate, GoingAheadWithADownwardCameraIsAVelocityForward) {
  const BodyFrames frames(looking_down());
  Rigid3 ahead = Rigid3::Identity();
  ahead.translation() << 0.05, 0, 0;
  const BodyTwist twist = body_twist(moved(ahead, frames), frames, std::chrono::milliseconds(50));
  ASSERT_TRUE(twist.valid);
  EXPECT_NEAR(twist.twist(0), 1.0, 1e-12);
  EXPECT_LT(twist.twist.tail<5>().norm(), 1e-12);
}

TEST(BodyEstimate, TurningOnTheSpotMovesTheCameraButNotTheBody) {
  const BodyFrames frames(looking_down());
  Vector6d turn = Vector6d::Zero();
  turn(5) = 0.01;  // clockwise as seen from above
  const FrameResult result = moved(se3_exp(turn), frames);
  EXPECT_GT(result.T_world_cam.translation().norm(), 1e-3);
  const BodyTwist twist = body_twist(result, frames, std::chrono::milliseconds(100));
  EXPECT_LT(twist.twist.head<3>().norm(), 1e-12);
  EXPECT_NEAR(twist.twist(5), 0.1, 1e-12);
  EXPECT_LT(frames.pose_of_body(result.T_world_cam).translation().norm(), 1e-12);
}

TEST(BodyEstimate, StartIsTheIdentityWhereverTheCameraSits) {
  const BodyFrames frames(looking_down());
  EXPECT_TRUE(frames.pose_of_body(Rigid3::Identity()).isApprox(Rigid3::Identity(), 1e-12));
}

// The covariance of the camera's motion must predict the scatter of the body's.
TEST(BodyEstimate, CovarianceOfTheVelocityIsThatOfPerturbedMotions) {
  const BodyFrames frames(looking_down());
  Vector6d step;
  step << 0.05, 0.01, -0.02, 0.02, -0.01, 0.03;
  const FrameResult result = moved(se3_exp(step), frames);
  const Duration dt = std::chrono::milliseconds(50);
  const BodyTwist center = body_twist(result, frames, dt);
  Matrix6d J;  // by differences
  for (int i = 0; i < 6; ++i) {
    constexpr double kStep = 1e-7;
    Vector6d xi = Vector6d::Zero();
    xi(i) = kStep;
    FrameResult perturbed = result;
    perturbed.T_curr_prev = se3_exp(xi) * result.T_curr_prev;
    J.col(i) = (body_twist(perturbed, frames, dt).twist - center.twist) / kStep;
  }
  const Matrix6d expected = J * result.cov_T_curr_prev * J.transpose();
  EXPECT_LT((center.cov_twist - expected).norm(), 0.05 * expected.norm());
}

TEST(BodyEstimate, VelocityOfABodyIsThatOfItsCentroidInTheWorldOfTheWire) {
  const BodyFrames frames(looking_down());
  ObjectState object;
  object.centroid_world = Eigen::Vector3d(0.5, 0.2, 3.0);
  object.M_world.translation() << 0.1, 0, 0;  // to the image's right
  const ObjectTwist twist = object_twist(object, frames, std::chrono::milliseconds(100));
  EXPECT_TRUE(twist.velocity_mps.isApprox(Eigen::Vector3d(0, 1, 0), 1e-12)) << twist.velocity_mps.transpose();
}

TEST(BodyEstimate, NothingIsSaidWithoutAPoseOrATime) {
  const BodyFrames frames(looking_down());
  FrameResult result = moved(Rigid3::Identity(), frames);
  EXPECT_FALSE(body_twist(result, frames, Duration{0}).valid);
  EXPECT_GE(quality_percent(result), 0);
  result.pose_valid = false;
  EXPECT_FALSE(body_twist(result, frames, std::chrono::milliseconds(50)).valid);
  EXPECT_EQ(quality_percent(result), -1);
}

}  // namespace
}  // namespace pelorus
