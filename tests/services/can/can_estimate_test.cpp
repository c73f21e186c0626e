#include "services/can/can_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace pelorus {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A camera that looks along the bow, mounted off the body origin: cam x = starboard, y = down, z = forward.
Rigid3 forward_mounting() {
  Rigid3 T_body_cam = Rigid3::Identity();
  T_body_cam.linear().col(0) = Eigen::Vector3d::UnitY();
  T_body_cam.linear().col(1) = Eigen::Vector3d::UnitZ();
  T_body_cam.linear().col(2) = Eigen::Vector3d::UnitX();
  T_body_cam.translation() = Eigen::Vector3d(0.8, -0.1, 0.3);
  return T_body_cam;
}

Rigid3 body_at(const Eigen::Vector3d& p_start_body, double yaw_rad, double pitch_rad = 0, double roll_rad = 0) {
  Rigid3 T_start_body = Rigid3::Identity();
  T_start_body.linear() =
      (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  T_start_body.translation() = p_start_body;
  return T_start_body;
}

// A vehicle whose body goes through given poses, seen by the camera as the service publishes it.
class Dive {
 public:
  explicit Dive(const Rigid3& T_body_cam) : T_body_cam_(T_body_cam) { now_.result.report.points_static = 200; }

  Publication at(const Rigid3& T_start_body, double time_s) {
    FrameResult& result = now_.result;
    const Rigid3 T_world_cam_prev = result.T_world_cam;
    const Timestamp time_prev = result.capture_time;
    result.T_world_cam = T_body_cam_.inverse() * T_start_body * T_body_cam_;
    result.T_curr_prev = result.T_world_cam.inverse() * T_world_cam_prev;
    result.cov_T_curr_prev = 1e-8 * Matrix6d::Identity();
    result.cov_T_world_cam = 1e-4 * Matrix6d::Identity();
    result.capture_time = Timestamp{1'000'000'000 + static_cast<std::int64_t>(std::llround(time_s * 1e9))};
    result.state = VisionState::tracking;
    result.pose_valid = true;
    result.world_confidence = 0.9;
    now_.step = any_ ? result.capture_time - time_prev : Duration{};
    any_ = true;
    return now_;
  }
  [[nodiscard]] Rigid3 to_world(const Rigid3& T_start_any) const { return T_body_cam_.inverse() * T_start_any; }

 private:
  Rigid3 T_body_cam_;
  Publication now_;
  bool any_ = false;
};

PreviousPose pose_of(const Publication& p) {
  return {true, p.result.capture_time, p.result.reset_counter, p.result.T_world_cam};
}

// As released at once.
CanEstimate estimate(const Publication& now, const PreviousPose& previous, const Rigid3& T_body_cam) {
  return estimate_of(now, previous, BodyFrames(T_body_cam), now.result.capture_time);
}

TEST(CanEstimate, DrivingForwardToStarboardAndDownIsPositiveWhateverTheMounting) {
  for (const Rigid3& T_body_cam : {Rigid3(Rigid3::Identity()), forward_mounting()}) {
    Dive dive(T_body_cam);
    const Publication first = dive.at(body_at({0, 0, 0}, 0), 0);
    const Publication second = dive.at(body_at({0.1, 0.02, 0.03}, 0), 0.1);
    const CanEstimate e = estimate(second, pose_of(first), T_body_cam);
    EXPECT_NEAR(e.vel_x_mps, 1.0, 1e-9);
    EXPECT_NEAR(e.vel_y_mps, 0.2, 1e-9);
    EXPECT_NEAR(e.vel_z_mps, 0.3, 1e-9);
    EXPECT_NEAR(e.position_x_m, 0.1, 1e-9);
    EXPECT_NEAR(e.interval_s, 0.1, 1e-12);
  }
}

TEST(CanEstimate, YawToStarboardPitchBowUpAndRollStarboardDownArePositive) {
  const Rigid3 T_body_cam = forward_mounting();
  Dive dive(T_body_cam);
  (void)dive.at(body_at({0, 0, 0}, 0), 0);
  const Publication now = dive.at(body_at({0, 0, 0}, 30 * kDegree, 10 * kDegree, 5 * kDegree), 0.1);
  const CanEstimate e = estimate(now, {}, T_body_cam);
  EXPECT_NEAR(e.yaw_rad, 30 * kDegree, 1e-9);
  EXPECT_NEAR(e.pitch_rad, 10 * kDegree, 1e-9);
  EXPECT_NEAR(e.roll_rad, 5 * kDegree, 1e-9);
  // In words: after yaw to starboard the bow points to +y of start, after pitch up to -z.
  const Eigen::Vector3d bow = body_at({0, 0, 0}, 30 * kDegree, 10 * kDegree).linear().col(0);
  EXPECT_GT(bow.y(), 0);
  EXPECT_LT(bow.z(), 0);
}

TEST(CanEstimate, TurningOnTheSpotMovesTheCameraButNotTheBody) {
  const Rigid3 T_body_cam = forward_mounting();
  Dive dive(T_body_cam);
  const Publication first = dive.at(body_at({1, 2, 3}, 0.3), 0);
  const Publication second = dive.at(body_at({1, 2, 3}, 0.4), 0.1);
  const CanEstimate e = estimate(second, pose_of(first), T_body_cam);
  EXPECT_NEAR(e.vel_x_mps, 0, 1e-9);
  EXPECT_NEAR(e.vel_y_mps, 0, 1e-9);
  EXPECT_NEAR(e.step_y_m, 0, 1e-9);
  EXPECT_NEAR(e.turn_z_rad, 0.1, 1e-9);
  EXPECT_GT((second.result.T_world_cam.translation() - first.result.T_world_cam.translation()).norm(), 0.05);
}

TEST(CanEstimate, StepsAndTurnsChainToThePose) {
  const Rigid3 T_body_cam = forward_mounting();
  Dive dive(T_body_cam);
  Rigid3 T_start_body = Rigid3::Identity();
  PreviousPose previous;
  Rigid3 T_chained = Rigid3::Identity();
  CanEstimate e;
  for (int k = 0; k < 40; ++k) {
    const Publication result = dive.at(T_start_body, 0.05 * k);
    e = estimate(result, previous, T_body_cam);
    if (k > 0) {
      Rigid3 T_prev_curr = Rigid3::Identity();
      T_prev_curr.linear() = so3_exp({e.turn_x_rad, e.turn_y_rad, e.turn_z_rad});
      T_prev_curr.translation() = Eigen::Vector3d(e.step_x_m, e.step_y_m, e.step_z_m);
      T_chained = T_chained * T_prev_curr;
    }
    previous = pose_of(result);
    T_start_body = T_start_body * body_at({0.05, 0.01, -0.02}, 0.03, -0.02, 0.01);
  }
  EXPECT_NEAR(T_chained.translation().x(), e.position_x_m, 1e-6);
  EXPECT_NEAR(T_chained.translation().y(), e.position_y_m, 1e-6);
  EXPECT_NEAR(T_chained.translation().z(), e.position_z_m, 1e-6);
  EXPECT_NEAR(std::atan2(T_chained.linear()(1, 0), T_chained.linear()(0, 0)), e.yaw_rad, 1e-6);
}

TEST(CanEstimate, TheFirstFrameHasAPoseButNoMotion) {
  Dive dive(forward_mounting());
  const Publication first = dive.at(Rigid3::Identity(), 0);
  const CanEstimate e = estimate(first, {}, forward_mounting());
  EXPECT_TRUE(std::isnan(e.vel_x_mps));
  EXPECT_TRUE(std::isnan(e.step_x_m));
  EXPECT_TRUE(std::isnan(e.sigma_vel_mps));
  EXPECT_DOUBLE_EQ(e.position_x_m, 0);
}

TEST(CanEstimate, ALostSystemSendsNoNumbersButAgeAndResets) {
  Dive dive(forward_mounting());
  const Publication first = dive.at(Rigid3::Identity(), 0);
  Publication lost = dive.at(body_at({1, 0, 0}, 0), 0.05);
  lost.result.state = VisionState::lost;
  lost.result.pose_valid = false;
  lost.result.reset_counter = 3;
  const CanEstimate e = estimate_of(lost, pose_of(first), BodyFrames(forward_mounting()),
                                    lost.result.capture_time + std::chrono::milliseconds(70));
  EXPECT_TRUE(std::isnan(e.vel_x_mps));
  EXPECT_TRUE(std::isnan(e.position_x_m));
  EXPECT_TRUE(std::isnan(e.roll_rad));
  EXPECT_TRUE(std::isnan(e.bodies));
  EXPECT_DOUBLE_EQ(e.quality_percent, 0);
  EXPECT_DOUBLE_EQ(e.resets, 3);
  EXPECT_NEAR(e.age_s, 0.07, 1e-9);
}

TEST(CanEstimate, ASkippedResultIsSpannedByThePosesAndItsVarianceGrows) {
  const Rigid3 T_body_cam = forward_mounting();
  Dive dive(T_body_cam);
  const Publication first = dive.at(Rigid3::Identity(), 0);
  (void)dive.at(body_at({0.1, 0, 0}, 0), 0.1);
  const Publication third = dive.at(body_at({0.3, 0, 0}, 0), 0.2);
  const CanEstimate spanned = estimate(third, pose_of(first), T_body_cam);
  EXPECT_NEAR(spanned.step_x_m, 0.3, 1e-9);
  EXPECT_NEAR(spanned.interval_s, 0.2, 1e-9);
  EXPECT_NEAR(spanned.vel_x_mps, 2.0, 1e-9) << "of the last frame interval";
  PreviousPose before_reset = pose_of(first);
  before_reset.reset_counter = 7;
  const CanEstimate alone = estimate(third, before_reset, T_body_cam);
  EXPECT_NEAR(alone.step_x_m, 0.2, 1e-9) << "poses before and after a reset have no difference";
  EXPECT_NEAR(alone.interval_s, 0.1, 1e-9);
  EXPECT_GT(spanned.step_var_x_mm2, 1.8 * alone.step_var_x_mm2);
}

// The covariance of the camera's step, carried to the body origin, against many drawn steps.
TEST(CanEstimate, DeviationOfVelocityMatchesDrawnSteps) {
  const Rigid3 T_body_cam = forward_mounting();
  Dive dive(T_body_cam);
  const Publication first = dive.at(Rigid3::Identity(), 0);
  Publication second = dive.at(body_at({0.05, 0, 0}, 0.01), 0.1);
  const double sigma_m = 1e-3;
  const double sigma_rad = 2e-3;
  second.result.cov_T_curr_prev.setZero();
  second.result.cov_T_curr_prev.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
      Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  const CanEstimate truth = estimate(second, pose_of(first), T_body_cam);
  std::srand(7);
  Eigen::Vector3d sum_mm2 = Eigen::Vector3d::Zero();
  constexpr int kDraws = 4000;
  for (int k = 0; k < kDraws; ++k) {
    // Sum of 12 uniforms: standard normal enough for a variance.
    Vector6d xi = Vector6d::Zero();
    for (int i = 0; i < 12; ++i) xi += 0.5 * Vector6d::Random();
    xi.head<3>() *= sigma_m;
    xi.tail<3>() *= sigma_rad;
    Publication drawn = second;
    drawn.result.T_curr_prev = se3_exp(xi) * second.result.T_curr_prev;
    const CanEstimate e = estimate(drawn, pose_of(first), T_body_cam);
    const Eigen::Vector3d d(e.step_x_m - truth.step_x_m, e.step_y_m - truth.step_y_m, e.step_z_m - truth.step_z_m);
    sum_mm2 += 1e6 * d.cwiseAbs2();
  }
  const Eigen::Vector3d drawn_mm2 = sum_mm2 / kDraws;
  EXPECT_NEAR(drawn_mm2.x() / truth.step_var_x_mm2, 1.0, 0.12);
  EXPECT_NEAR(drawn_mm2.y() / truth.step_var_y_mm2, 1.0, 0.12);
  EXPECT_NEAR(drawn_mm2.z() / truth.step_var_z_mm2, 1.0, 0.12);
  EXPECT_GE(truth.sigma_vel_mps * 0.1 * 1000, std::sqrt(truth.step_var_y_mm2) * (1 - 1e-9));
}

ObjectState body_seen(std::int32_t id, const Eigen::Vector3d& p_world, const Eigen::Vector3d& step_world) {
  ObjectState object;
  object.id = BodyId{id};
  object.phase = ObjectPhase::confirmed;
  object.motion_measured = true;
  object.centroid_world = p_world;
  object.M_world.translation() = step_world;
  object.points = 30;
  return object;
}

TEST(CanEstimate, TheNearestBodyIsToldInBearingElevationRangeAndClosingSpeed) {
  const Rigid3 T_body_cam = forward_mounting();
  Dive dive(T_body_cam);
  const Publication first = dive.at(Rigid3::Identity(), 0);
  Publication now = dive.at(body_at({0.1, 0, 0}, 0), 0.1);
  const Rigid3 T_world_start = dive.to_world(Rigid3::Identity());
  const Eigen::Vector3d p_body(4, 3, -1);  // ahead, to starboard, above
  const Eigen::Vector3d p_start = p_body + Eigen::Vector3d(0.1, 0, 0);
  now.result.objects[0] = body_seen(300, T_world_start * Eigen::Vector3d(20, 0, 0), Eigen::Vector3d::Zero());
  now.result.objects[1] = body_seen(256, T_world_start * p_start, Eigen::Vector3d::Zero());
  now.result.objects[2] = body_seen(3, T_world_start * Eigen::Vector3d(1, 0, 0), Eigen::Vector3d::Zero());
  now.result.objects[2].phase = ObjectPhase::tentative;
  now.result.objects_size = 3;
  const CanEstimate e = estimate(now, pose_of(first), T_body_cam);
  EXPECT_DOUBLE_EQ(e.bodies, 2) << "the tentative one is no body yet";
  EXPECT_NEAR(e.object_range_m, p_body.norm(), 1e-9);
  EXPECT_NEAR(e.object_bearing_rad, std::atan2(3, 4), 1e-9);
  EXPECT_NEAR(e.object_elevation_rad, std::asin(1 / p_body.norm()), 1e-9);
  EXPECT_DOUBLE_EQ(e.object_id, 1) << "256 modulo 255";
  EXPECT_DOUBLE_EQ(e.object_phase, 1);
  EXPECT_DOUBLE_EQ(e.object_confidence_percent, 75);
  // A body at rest 0.1 m nearer after 0.1 s of 1 m/s towards it.
  EXPECT_NEAR(e.object_closing_mps, (Eigen::Vector3d(4.1, 3, -1).norm() - p_body.norm()) / 0.1, 1e-9);
  EXPECT_GT(e.object_closing_mps, 0);
}

TEST(CanEstimate, ABodyThatMovesAlongKeepsItsRange) {
  const Rigid3 T_body_cam = forward_mounting();
  Dive dive(T_body_cam);
  const Publication first = dive.at(Rigid3::Identity(), 0);
  Publication now = dive.at(body_at({0.1, 0, 0}, 0), 0.1);
  const Rigid3 T_world_start = dive.to_world(Rigid3::Identity());
  now.result.objects[0] =
      body_seen(1, T_world_start * Eigen::Vector3d(5, 1, 0), T_world_start.linear() * Eigen::Vector3d(0.1, 0, 0));
  now.result.objects_size = 1;
  EXPECT_NEAR(estimate(now, pose_of(first), T_body_cam).object_closing_mps, 0, 1e-9);
}

TEST(CanEstimate, QualityIsZeroOnlyWithoutAPose) {
  Dive dive(forward_mounting());
  Publication p = dive.at(Rigid3::Identity(), 0);
  EXPECT_DOUBLE_EQ(estimate(p, {}, forward_mounting()).quality_percent, 100);
  p.result.report.points_static = 0;
  EXPECT_DOUBLE_EQ(estimate(p, {}, forward_mounting()).quality_percent, 1);
  p.result.pose_valid = false;
  EXPECT_DOUBLE_EQ(estimate(p, {}, forward_mounting()).quality_percent, 0);
}

// VIS_ODOM and CAN are read side by side: one number for one thing.
TEST(CanEstimate, VelocityIsTheOneThatLcmSends) {
  const Rigid3 T_body_cam = forward_mounting();
  Dive dive(T_body_cam);
  (void)dive.at(Rigid3::Identity(), 0);
  const Publication now = dive.at(body_at({0.1, 0.05, -0.02}, 0.2, 0.1, -0.1), 0.1);
  const CanEstimate e = estimate(now, {}, T_body_cam);
  const BodyTwist lcm = body_twist(now.result, BodyFrames(T_body_cam), now.step);
  EXPECT_DOUBLE_EQ(e.vel_x_mps, lcm.twist[0]);
  EXPECT_DOUBLE_EQ(e.vel_y_mps, lcm.twist[1]);
  EXPECT_DOUBLE_EQ(e.vel_z_mps, lcm.twist[2]);
}

TEST(CanEstimate, AMeasurementFromTheFutureHasNoAge) {
  Dive dive(forward_mounting());
  const Publication result = dive.at(Rigid3::Identity(), 1);
  EXPECT_TRUE(std::isnan(
      estimate_of(result, {}, BodyFrames(forward_mounting()), Timestamp{result.result.capture_time.ns - 1}).age_s));
}

}  // namespace
}  // namespace pelorus
