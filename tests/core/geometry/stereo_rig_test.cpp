#include "core/geometry/stereo_rig.h"

#include <gtest/gtest.h>

#include <random>

namespace pelorus {
namespace {

const StereoRig kRig{1024, 768, 800.0, 511.5, 383.5, 0.12};

TEST(StereoRig, TriangulateInvertsProject) {
  const Eigen::Vector3d p_cam(0.3, -0.2, 3.1);
  EXPECT_LT((kRig.triangulate(kRig.project(p_cam)) - p_cam).norm(), 1e-9);
}

TEST(StereoRig, JacobianMatchesFiniteDifferences) {
  const Eigen::Vector3d p_cam(0.3, -0.2, 3.1);
  const Eigen::Matrix3d J = kRig.project_jacobian(p_cam);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d d = Eigen::Vector3d::Unit(i) * kStep;
    const Eigen::Vector3d numeric = (kRig.project(p_cam + d) - kRig.project(p_cam - d)) / (2 * kStep);
    EXPECT_LT((numeric - J.col(i)).norm(), 1e-4) << "column " << i;
  }
}

TEST(StereoRig, TriangulateJacobianInvertsProjectJacobian) {
  const Eigen::Vector3d p_cam(0.3, -0.2, 3.1);
  const Eigen::Matrix3d product = kRig.triangulate_jacobian(p_cam) * kRig.project_jacobian(p_cam);
  EXPECT_TRUE(product.isApprox(Eigen::Matrix3d::Identity(), 1e-12));
}

TEST(StereoRig, CovarianceMatchesSampledScatter) {
  std::mt19937 rng(5);
  std::normal_distribution<double> noise(0.0, 0.25);
  const Eigen::Vector3d z = kRig.project({0.4, 0.1, 3.0});
  const Eigen::Matrix3d predicted = kRig.triangulate_covariance(z, Eigen::Matrix3d::Identity() * 0.0625);
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d e =
        kRig.triangulate(z + Eigen::Vector3d(noise(rng), noise(rng), noise(rng))) - kRig.triangulate(z);
    sampled += e * e.transpose() / kSamples;
  }
  // 20000 samples give variances to 1 %; the rest is the second order of 1/disparity.
  EXPECT_LT((sampled - predicted).norm(), 0.05 * predicted.norm());
}

TEST(StereoRig, DepthSigmaIsTheKnownFormula) {
  const Eigen::Vector3d z = kRig.project({0, 0, 4.0});
  const Eigen::Matrix3d cov = kRig.triangulate_covariance(z, Eigen::Matrix3d::Identity() * 0.0625);
  EXPECT_NEAR(std::sqrt(cov(2, 2)), kRig.depth_sigma_m(4.0, 0.25 * std::sqrt(2.0)), 1e-3 * std::sqrt(cov(2, 2)));
}

}  // namespace
}  // namespace pelorus
