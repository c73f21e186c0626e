#include "drivers/synthetic/pose_path.h"

#include <gtest/gtest.h>

namespace pelorus::synthetic {
namespace {

PosePath winding_path() {
  PosePath path;
  path.step_s = 0.8;
  path.p_sea = {{0, 0, 1}, {1, 0.4, 1.2}, {1.5, 1.1, 0.9}, {2.6, 0.7, 1.1}, {3, 0, 1}};
  path.rpy_rad = {{0, 0, 0}, {0.2, -0.1, 0.5}, {0.1, 0.3, 0.9}, {-0.2, 0.1, 1.2}, {0, 0, 1.8}};
  return path;
}

// Second difference over h^2 of everything that moves.
Vector6d acceleration(const PosePath& path, double t_s) {
  constexpr double kStepS = 1e-4;
  const Rigid3 T_now = path.T_sea_b(t_s);
  const Rigid3 T_before = path.T_sea_b(t_s - kStepS);
  const Rigid3 T_after = path.T_sea_b(t_s + kStepS);
  Vector6d a;
  a.head<3>() = T_after.translation() - 2 * T_now.translation() + T_before.translation();
  a.tail<3>() =
      so3_log(T_now.linear().transpose() * T_after.linear()) - so3_log(T_before.linear().transpose() * T_now.linear());
  return a / (kStepS * kStepS);
}

TEST(PosePath, AccelerationHasNoJumpAnywhereNotEvenAtControlPoints) {
  PosePath path = winding_path();
  path.sway = {0.02, 0.01, 3};
  constexpr double kStepS = 1e-3;
  for (double t_s = 0.01; t_s < 5; t_s += kStepS) {
    // Jerk stays far below 100 m/s^3 for these paths; a jump of velocity would give 1e4, one of acceleration 1e3.
    const Vector6d jump = acceleration(path, t_s + kStepS) - acceleration(path, t_s);
    ASSERT_LT(jump.norm(), 100 * kStepS) << "at " << t_s << " s";
  }
}

TEST(PosePath, StartsAtTheFirstPointAndReachesTheLast) {
  const PosePath path = winding_path();
  EXPECT_DOUBLE_EQ(path.duration_s(), 3.2);
  EXPECT_LT((path.T_sea_b(0).translation() - path.p_sea.front()).norm(), 1e-12);
  EXPECT_LT((path.T_sea_b(3.2).translation() - path.p_sea.back()).norm(), 1e-12);
}

TEST(PosePath, RepeatedPointsStandStillExactly) {
  PosePath path = winding_path();
  path.p_sea.assign(6, Eigen::Vector3d(1.1, 2.2, 3.3));
  path.p_sea[0] = {0, 0, 0};
  path.rpy_rad.assign(6, Eigen::Vector3d(0.1, 0.2, 0.3));
  const Rigid3 T_rest = path.T_sea_b(2.5 * path.step_s);
  for (double t_s = 2.0 * path.step_s; t_s <= 5 * path.step_s; t_s += 0.01) {
    ASSERT_EQ(path.T_sea_b(t_s).matrix(), T_rest.matrix()) << "at " << t_s << " s";
  }
}

TEST(PosePath, OnePointStandsStillAndTwoMakeConstantVelocity) {
  PosePath path;
  path.p_sea = {{1, 2, 3}};
  path.rpy_rad = {{0, 0, 0}};
  EXPECT_TRUE(path.stands_still());
  path.p_sea.emplace_back(1.5, 2, 3);
  EXPECT_FALSE(path.stands_still());
  const Eigen::Vector3d v_first = path.T_sea_b(0.1).translation() - path.T_sea_b(0).translation();
  const Eigen::Vector3d v_late = path.T_sea_b(7.1).translation() - path.T_sea_b(7).translation();
  EXPECT_LT((v_first - Eigen::Vector3d(0.05, 0, 0)).norm(), 1e-12);
  EXPECT_LT((v_late - v_first).norm(), 1e-12);
}

TEST(PosePath, SwayDependsOnItsSeedAndStaysWithinItsAmplitude) {
  PosePath calm = winding_path();
  PosePath one = calm;
  one.sway = {0.02, 0.01, 3};
  one.sway_seed = 1;
  PosePath other = one;
  other.sway_seed = 2;
  double largest_m = 0;
  for (double t_s = 0; t_s < 6; t_s += 0.05) {
    const Eigen::Vector3d offset = one.T_sea_b(t_s).translation() - calm.T_sea_b(t_s).translation();
    largest_m = std::max(largest_m, offset.cwiseAbs().maxCoeff());
  }
  EXPECT_LE(largest_m, 0.02);
  EXPECT_GT(largest_m, 0.01);
  EXPECT_GT((one.T_sea_b(1).translation() - other.T_sea_b(1).translation()).norm(), 1e-3);
}

}  // namespace
}  // namespace pelorus::synthetic
