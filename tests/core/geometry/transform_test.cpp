#include "core/geometry/transform.h"

#include <gtest/gtest.h>

#include <random>

namespace pelorus {
namespace {

Vector6d random_twist(std::mt19937& rng, double scale) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = uniform(rng);
  return xi;
}

TEST(Transform, LogarithmInvertsExponential) {
  std::mt19937 rng(1);
  for (double scale : {1e-9, 1e-4, 0.1, 1.5}) {
    for (int i = 0; i < 50; ++i) {
      const Vector6d xi = random_twist(rng, scale);
      EXPECT_LT((se3_log(se3_exp(xi)) - xi).norm(), 1e-9 * (1 + scale));
    }
  }
}

TEST(Transform, AdjointMovesATwistThroughATransform) {
  std::mt19937 rng(2);
  const Rigid3 T = se3_exp(random_twist(rng, 1.0));
  const Vector6d xi = random_twist(rng, 0.3);
  const Rigid3 direct = T * se3_exp(xi) * T.inverse();
  EXPECT_TRUE(direct.isApprox(se3_exp(adjoint(T) * xi), 1e-12));
}

// Erratum of the paper's eq. (2): own motion is H_static^-1 * H, and the printed order H * H_static^-1 differs
// as soon as both camera and object rotate (method section 1).
TEST(Transform, OwnMotionFollowsTheDerivedOrderNotThePrintedOne) {
  std::mt19937 rng(3);
  const Rigid3 T_world_prev = se3_exp(random_twist(rng, 0.5));
  const Rigid3 T_world_curr = T_world_prev * se3_exp(random_twist(rng, 0.2));
  const Rigid3 M_world = se3_exp(random_twist(rng, 0.2));
  const Rigid3 H_static = T_world_curr.inverse() * T_world_prev;
  const Rigid3 H = T_world_curr.inverse() * M_world * T_world_prev;

  EXPECT_TRUE((T_world_curr * H * T_world_prev.inverse()).isApprox(M_world, 1e-12));
  const Rigid3 M_prev = H_static.inverse() * H;
  EXPECT_TRUE((T_world_prev * M_prev * T_world_prev.inverse()).isApprox(M_world, 1e-12));
  const Rigid3 printed = H * H_static.inverse();
  EXPECT_FALSE((T_world_prev * printed * T_world_prev.inverse()).isApprox(M_world, 1e-3));
}

TEST(Transform, StaticGroupHasIdentityOwnMotion) {
  std::mt19937 rng(4);
  const Rigid3 T_world_prev = se3_exp(random_twist(rng, 0.5));
  const Rigid3 T_world_curr = T_world_prev * se3_exp(random_twist(rng, 0.2));
  const Rigid3 H = T_world_curr.inverse() * T_world_prev;
  EXPECT_TRUE((T_world_curr * H * T_world_prev.inverse()).isApprox(Rigid3::Identity(), 1e-12));
}

TEST(Transform, OrthonormalizedRepairsADriftedRotation) {
  Rigid3 T = se3_exp((Vector6d() << 1, 2, 3, 0.1, 0.2, 0.3).finished());
  T.linear() *= 1.001;
  const Rigid3 repaired = orthonormalized(T);
  EXPECT_NEAR(repaired.linear().determinant(), 1.0, 1e-12);
  EXPECT_TRUE((repaired.linear() * repaired.linear().transpose()).isApprox(Eigen::Matrix3d::Identity(), 1e-12));
}

}  // namespace
}  // namespace pelorus
