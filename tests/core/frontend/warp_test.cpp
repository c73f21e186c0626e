#include "core/frontend/warp.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/point_world.h"

namespace pelorus {
namespace {

using test::kRig;
using test::twist;

// A plane n . p = 1 [1/m]: its point at a pixel, and the gradient of its disparity, which is b * (n_x, n_y).
struct Plane {
  Eigen::Vector3d n{0.08, -0.05, 0.4};

  [[nodiscard]] Eigen::Vector3d at(double u_px, double v_px) const {
    const Eigen::Vector3d ray((u_px - kRig.cx_px) / kRig.f_px, (v_px - kRig.cy_px) / kRig.f_px, 1.0);
    return ray / n.dot(ray);
  }
  [[nodiscard]] Eigen::Vector2d disparity_gradient() const { return kRig.baseline_m * n.head<2>(); }
};

void expect_near(const Warp& warp, const Eigen::Matrix2d& W, double tolerance) {
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(static_cast<double>(warp[k]), W(static_cast<Eigen::Index>(k / 2), static_cast<Eigen::Index>(k % 2)),
                tolerance);
  }
}

// Where the surface at a pixel and one offset from it go: the derivative, by central differences.
template <class Project>
Eigen::Matrix2d differences(Project&& project) {
  constexpr double kStep_px = 0.01;
  Eigen::Matrix2d W;
  W.col(0) = (project(600 + kStep_px, 300) - project(600 - kStep_px, 300)) / (2 * kStep_px);
  W.col(1) = (project(600, 300 + kStep_px) - project(600, 300 - kStep_px)) / (2 * kStep_px);
  return W;
}

TEST(Warp, OfAStepIsTheDerivativeOfTheImageMotionOfASlantedSurface) {
  const Plane plane;
  const Rigid3 H = se3_exp(twist(0.1, -0.05, 0.3, 0.05, -0.1, 0.2));
  const Eigen::Matrix2d W =
      differences([&](double u, double v) { return Eigen::Vector2d(kRig.project(H * plane.at(u, v)).head<2>()); });
  expect_near(step_warp(kRig, H, plane.at(600, 300), plane.disparity_gradient()), W, 1e-5);
}

TEST(Warp, FromLeftToRightIsTheDerivativeOfTheRightImage) {
  const Plane plane;
  const Eigen::Matrix2d W = differences([&](double u, double v) {
    const Eigen::Vector3d z_px = kRig.project(plane.at(u, v));
    return Eigen::Vector2d(z_px.z(), z_px.y());
  });
  expect_near(stereo_warp(plane.disparity_gradient()), W, 1e-6);
}

TEST(Warp, RestLeavesAPatchAsItIs) {
  const Plane plane;
  expect_near(step_warp(kRig, Rigid3::Identity(), plane.at(600, 300), plane.disparity_gradient()),
              Eigen::Matrix2d::Identity(), 1e-6);
}

TEST(Warp, ThereAndBackIsTheIdentityAndTheOrderOfComposingIsLaterFirst) {
  const Warp a{1.2F, 0.1F, -0.2F, 0.9F};
  const Warp b{0.8F, -0.3F, 0.05F, 1.1F};
  expect_near(compose_warp(inverse_warp(a), a), Eigen::Matrix2d::Identity(), 1e-6);
  Eigen::Matrix2d A, B;
  A << 1.2, 0.1, -0.2, 0.9;
  B << 0.8, -0.3, 0.05, 1.1;
  expect_near(compose_warp(a, b), A * B, 1e-6);
}

TEST(Warp, BehindTheCameraAndASingularWarpAreTheIdentity) {
  const Plane plane;
  const Rigid3 H = Rigid3(Eigen::Translation3d(0, 0, -10));
  expect_near(step_warp(kRig, H, plane.at(600, 300), {0, 0}), Eigen::Matrix2d::Identity(), 0);
  expect_near(inverse_warp({1, 2, 2, 4}), Eigen::Matrix2d::Identity(), 0);
}

TEST(Warp, IsUsableWhileThePatchLooksLikeItself) {
  EXPECT_TRUE(usable_warp({1, 0, 0, 1}));
  EXPECT_TRUE(usable_warp({0, -1.5F, 1.5F, 0}));  // turned and larger
  EXPECT_FALSE(usable_warp({1.7F, 0, 0, 1.7F}));
  EXPECT_FALSE(usable_warp({0.5F, 0, 0, 0.5F}));
  EXPECT_FALSE(usable_warp({1, 1, 0, 1}));   // sheared
  EXPECT_FALSE(usable_warp({1, 0, 0, -1}));  // mirrored
}

}  // namespace
}  // namespace pelorus
