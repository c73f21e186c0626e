#include "core/evaluation/consistency.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "tests/core/evaluation/hand_made_run.h"

namespace pelorus {
namespace {

using test::hand_made;
using test::HandMade;

constexpr std::size_t kFrames = 500;

Matrix6d correlated_covariance() {
  Matrix6d root = Matrix6d::Zero();
  root.diagonal() << 2e-3, 1e-3, 5e-3, 4e-4, 3e-4, 2e-4;
  root(1, 0) = 5e-4;
  root(4, 2) = 1e-4;
  return root * root.transpose();
}

class Noise {
 public:
  Rigid3 draw(double scale) {
    Vector6d unit;
    for (int i = 0; i < 6; ++i) unit(i) = normal_(rng_);
    const Matrix6d root = correlated_covariance().llt().matrixL();
    return se3_exp(scale * (root * unit));
  }

 private:
  std::mt19937 rng_{11};
  std::normal_distribution<double> normal_;
};

HandMade noisy(double scale) {
  HandMade made = hand_made(kFrames, 1);
  Noise noise;
  for (std::size_t i = 1; i < kFrames; ++i) {
    made.run[i].T_curr_prev = noise.draw(scale) * *made.run[i].T_curr_prev;
    made.run[i].cov_T_curr_prev = correlated_covariance();
    EstimatedObject& object = made.object(i, 0);
    Rigid3 T_world_centroid = Rigid3::Identity();
    T_world_centroid.translation() = object.centroid_world;
    object.M_world = T_world_centroid * noise.draw(scale) * T_world_centroid.inverse() * object.M_world;
    object.cov_M_centroid = correlated_covariance();
  }
  return made;
}

Consistency of_object(const HandMade& made) {
  return summarize_nees(
      object_nees(made.run, made.truth, associate(made.run, made.truth, {}), 0, test::T_truth_world()));
}

TEST(Consistency, NoiseOfTheReportedCovarianceIsInsideTheBand) {
  const HandMade made = noisy(1.0);
  const auto ego = ego_consistency(made.run, made.truth);
  ASSERT_TRUE(ego);
  EXPECT_EQ(ego->count, kFrames - 1);
  EXPECT_TRUE(ego->is_inside_band()) << ego->mean_nees;
  EXPECT_NEAR(ego->share_inside, 0.95, 0.03);
  EXPECT_TRUE(of_object(made).is_inside_band()) << of_object(made).mean_nees;
}

TEST(Consistency, OverconfidenceAndModestyAreBothOutsideTheBand) {
  EXPECT_GT(ego_consistency(noisy(1.5).run, noisy(1.5).truth)->mean_nees,
            ego_consistency(noisy(1.5).run, noisy(1.5).truth)->band_high);
  const HandMade modest = noisy(0.7);
  const Consistency object = of_object(modest);
  EXPECT_LT(object.mean_nees, object.band_low);
  EXPECT_FALSE(object.is_inside_band());
}

TEST(Consistency, UnknownCovarianceIsNotJudged) {
  const HandMade made = hand_made(10, 1);
  EXPECT_FALSE(ego_consistency(made.run, made.truth));
  EXPECT_EQ(of_object(made).count, 0U);
}

TEST(Consistency, NormalizedSquareIsTheMahalanobisDistance) {
  Matrix6d cov = Matrix6d::Identity();
  cov(0, 0) = 4;
  EXPECT_DOUBLE_EQ(nees((Vector6d() << 2, 1, 0, 0, 0, 3).finished(), cov).value(), 11);
  cov(1, 1) = -1;
  EXPECT_FALSE(nees(Vector6d::Ones(), cov));
}

// Tables of the chi-square distribution.
TEST(Consistency, QuantilesAgreeWithTheTables) {
  EXPECT_NEAR(chi_square_quantile(0.95, 6), 12.592, 0.05);
  EXPECT_NEAR(chi_square_quantile(0.025, 6), 1.237, 0.04);
  EXPECT_NEAR(chi_square_quantile(0.975, 600), 669.77, 0.2);
  EXPECT_NEAR(chi_square_quantile(0.025, 600), 534.02, 0.2);
}

}  // namespace
}  // namespace pelorus
