#include "core/kernels/transfer.h"

#include <gtest/gtest.h>

#include <random>

#include "core/motion/stereo_transfer.h"
#include "core/motion/transfer_points.h"
#include "tests/core/kernels/each_target.h"

namespace pelorus {
namespace {

const StereoRig kRig{1024, 768, 800.0, 511.5, 383.5, 0.12};

struct Scene {
  std::vector<PointPair> pairs;
  std::vector<PointIndex> all;
  Rigid3 motion = Rigid3::Identity();
};

Scene scene_of(std::size_t points, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> around(-1.0, 1.0);
  Scene scene;
  Vector6d twist;
  for (int k = 0; k < 6; ++k) twist[k] = 0.1 * around(rng);
  scene.motion = se3_exp(twist);
  for (std::size_t i = 0; i < points; ++i) {
    PointPair pair;
    const Eigen::Vector3d p_prev(2 * around(rng), around(rng), 4 + around(rng));
    pair.prev.z_px = kRig.project(p_prev);
    pair.prev.p_cam = kRig.triangulate(pair.prev.z_px);
    pair.curr.z_px = kRig.project(scene.motion * p_prev) + Eigen::Vector3d(around(rng), around(rng), around(rng));
    pair.sigma_px = 0.3 + 0.2 * around(rng);
    scene.pairs.push_back(pair);
    scene.all.push_back(static_cast<PointIndex>(i));
  }
  return scene;
}

TEST(Transfer, EveryInstructionSetEqualsTheReferenceBitByBit) {
  std::vector<double> values(9 * 16);
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> near_one(0.5, 1.5);
  for (double& value : values) value = near_one(rng);
  values[2 * 16 + 3] = -8.0;  // behind the camera
  const auto at = [&](std::size_t c) { return values.data() + 16 * c; };
  const TransferColumns columns{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), 16};
  const TransferMotion motion{
      {0.9, 0.1, -0.2, -0.1, 0.95, 0.05, 0.2, -0.03, 0.97}, {0.1, -0.2, 0.3}, 800, 511, 383, 0.1};
  std::vector<double> expected(16);
  reference::transfer_chi2(motion, columns, expected.data());
  EXPECT_EQ(expected[3], kImpossibleChi2);
  for_each_target([&] {
    std::vector<double> got(16);
    transfer_chi2(motion, columns, got.data());
    EXPECT_EQ(got, expected);
  });
}

TEST(Transfer, AgreesWithTheMatrixForm) {
  const Scene scene = scene_of(37, 5);
  TransferPoints points;
  points.assign(kRig, scene.pairs, scene.all);
  const auto chi2 = points.chi2(kRig, scene.motion);
  ASSERT_EQ(chi2.size(), scene.pairs.size());
  for (std::size_t i = 0; i < chi2.size(); ++i) {
    const double expected = transfer_chi2(kRig, scene.motion, scene.pairs[i]);
    EXPECT_NEAR(chi2[i], expected, 1e-7 * (1 + expected));
  }
}

// Far points under wild proposals come to lie beside the camera's centre, where the covariance cannot be inverted.
TEST(Transfer, WildMotionsNeverGiveANegativeSquare) {
  std::mt19937 rng(11);
  std::normal_distribution<double> unit;
  Scene scene = scene_of(40, 7);
  for (PointPair& pair : scene.pairs) {  // 30 to 150 m off
    const Eigen::Vector3d p_prev(5 * unit(rng), 2 * unit(rng), 30 + 120 * std::abs(std::sin(unit(rng))));
    pair.prev.z_px = kRig.project(p_prev);
    pair.prev.p_cam = kRig.triangulate(pair.prev.z_px);
  }
  TransferPoints points;
  points.assign(kRig, scene.pairs, scene.all);
  for (int k = 0; k < 2000; ++k) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? 40 : 0.5) * unit(rng);
    const auto chi2 = points.chi2(kRig, se3_exp(xi));
    for (std::size_t i = 0; i < chi2.size(); ++i) {
      ASSERT_GE(chi2[i], 0) << "motion " << k << ", point " << i;
      ASSERT_GE(transfer_chi2(kRig, se3_exp(xi), scene.pairs[i]), 0) << "motion " << k << ", point " << i;
    }
  }
}

TEST(Transfer, TakesEveryStridethPoint) {
  const Scene scene = scene_of(20, 6);
  TransferPoints points;
  points.assign(kRig, scene.pairs, scene.all, 3);
  const auto chi2 = points.chi2(kRig, scene.motion);
  ASSERT_EQ(chi2.size(), 7u);
  EXPECT_NEAR(chi2[6], transfer_chi2(kRig, scene.motion, scene.pairs[18]), 1e-6);
}

}  // namespace
}  // namespace pelorus
