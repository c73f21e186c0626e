#include "core/motion/two_frame_ba.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/geometry/rigid_fit.h"
#include "core/motion/motion_proposal.h"
#include "core/motion/stereo_transfer.h"
#include "tests/support/point_world.h"

namespace pelorus {
namespace {

using test::kRig;
using test::PointWorld;
using test::twist;
using test::WorldView;

constexpr double kChi2_6dof_9999 = 27.86;

MotionFit fit(const WorldView& view, const std::vector<PointIndex>& members,
              const Rigid3& H_start = Rigid3::Identity()) {
  TwoFrameBa ba({}, 1000);
  return ba.run(kRig, view.pairs, members, H_start);
}

double nees(const Rigid3& H_true, const MotionFit& fit) {
  const Vector6d xi = se3_log(H_true * fit.H_curr_prev.inverse());
  return xi.dot(fit.cov_H.inverse() * xi);
}

WorldView mover(double noise_px, double sigma_px, std::uint64_t seed = 1) {
  PointWorld world(0);
  world.add_body(80, {0.2, -0.1, 2.0}, 0.3, twist(0.02, -0.01, 0.03, 0.01, 0.02, -0.03));
  return world.observe(2, noise_px, sigma_px, seed);
}

void reverse_time(WorldView& view) {
  for (PointPair& pair : view.pairs) std::swap(pair.prev, pair.curr);
}

TEST(TwoFrameBa, FindsTheExactMotionOfExactPoints) {
  const WorldView view = mover(0, 0.1);
  const MotionFit found = fit(view, view.all());
  ASSERT_EQ(found.outcome, StageOutcome::ok);
  EXPECT_LT(se3_log(found.H_curr_prev * view.H_curr_prev(1).inverse()).norm(), 1e-8);
  EXPECT_EQ(found.support, 80);
}

TEST(TwoFrameBa, TimeReversedGivesTheInverseMotion) {
  WorldView view = mover(0.2, 0.2);
  const MotionFit forth = fit(view, view.all());
  reverse_time(view);
  const MotionFit back = fit(view, view.all());
  ASSERT_EQ(forth.outcome, StageOutcome::ok);
  ASSERT_EQ(back.outcome, StageOutcome::ok);
  // Not the same estimate up to rounding, since points are eliminated in the one frame: well within its deviation.
  const Vector6d xi = se3_log(back.H_curr_prev * forth.H_curr_prev);
  EXPECT_LT(xi.dot(back.cov_H.inverse() * xi), 0.01);
}

TEST(TwoFrameBa, CovarianceTellsTheTrueErrorOver200Trials) {
  constexpr int kTrials = 200;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const WorldView view = mover(0.25, 0.25, 100 + static_cast<std::uint64_t>(trial));
    sum += nees(view.H_curr_prev(1), fit(view, view.all()));
  }
  // Mean of 200 chi-squares of 6 degrees of freedom: 6 +- 1.96 sqrt(12 / 200) = 6 +- 0.48, and a little for the
  // scale, which is estimated from the residuals.
  EXPECT_NEAR(sum / kTrials, 6.0, 0.75);
}

TEST(TwoFrameBa, CovarianceFollowsTheNoiseNotTheAssumption) {
  // The pairs state 0.1 px, the noise is 0.2 px: the residuals scale the covariance.
  constexpr int kTrials = 60;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const WorldView view = mover(0.2, 0.1, 900 + static_cast<std::uint64_t>(trial));
    sum += nees(view.H_curr_prev(1), fit(view, view.all()));
  }
  EXPECT_LT(sum / kTrials, 9.0);  // unscaled: 24
  EXPECT_GT(sum / kTrials, 4.0);
}

TEST(TwoFrameBa, WhereSomePointsAreNoisierThanOthersTheCovarianceTellsIt) {
  // Dim water: one point in four has four times the noise of the others, and nothing says which.
  constexpr int kTrials = 200;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    WorldView view = mover(0, 0.2);
    std::mt19937_64 random(static_cast<std::uint64_t>(trial));
    std::normal_distribution<double> normal(0, 1);
    for (std::size_t i = 0; i < view.pairs.size(); ++i) {
      const double sigma_px = i % 4 == 0 ? 0.6 : 0.15;
      for (StereoPoint* point : {&view.pairs[i].prev, &view.pairs[i].curr}) {
        for (int d = 0; d < 3; ++d) point->z_px[d] += sigma_px * normal(random);
      }
    }
    sum += nees(view.H_curr_prev(1), fit(view, view.all()));
  }
  EXPECT_NEAR(sum / kTrials, 6.0, 0.75);
}

TEST(TwoFrameBa, SwitchedOffItIsTheAlignmentOfTheTwoClouds) {
  const WorldView view = mover(0.2, 0.3);  // all of them agree
  TwoFrameBa off({.adjust = false}, 1000);
  const MotionFit found = off.run(kRig, view.pairs, view.all(), Rigid3::Identity());
  std::vector<PointMatch> clouds;
  for (const PointPair& pair : view.pairs) clouds.push_back({pair.prev.p_cam, pair.curr.p_cam, 1.0});
  const auto aligned = fit_rigid(clouds);
  ASSERT_TRUE(aligned);
  EXPECT_LT(se3_log(found.H_curr_prev * aligned->inverse()).norm(), 1e-9);
  EXPECT_GT(se3_log(found.H_curr_prev * fit(view, view.all()).H_curr_prev.inverse()).norm(), 1e-4);
}

TEST(TwoFrameBa, TwoPointsAreTooFew) {
  const WorldView view = mover(0, 0.1);
  const Rigid3 H_start = se3_exp(twist(0.1, 0, 0, 0, 0, 0));
  const MotionFit found = fit(view, {0, 1}, H_start);
  EXPECT_EQ(found.outcome, StageOutcome::too_few_points);
  EXPECT_TRUE(found.H_curr_prev.isApprox(H_start));
}

TEST(TwoFrameBa, PointsOnALineAreDegenerateOrSaySoInTheCovariance) {
  WorldView view;
  const Rigid3 H_true = se3_exp(twist(0.02, 0.01, 0, 0, 0, 0.01));
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d p(-0.5 + 0.05 * i, 0.1, 2.0);
    view.pairs.push_back(PointWorld::pair_of({kRig.project(p), kRig.project(H_true * p)}, 0.1, TrackId{1}));
  }
  std::vector<PointIndex> members(20);
  std::iota(members.begin(), members.end(), 0);
  const MotionFit found = fit(view, members);
  const double worst_rad =
      std::sqrt(found.cov_H.bottomRightCorner<3, 3>().selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
  EXPECT_TRUE(found.outcome == StageOutcome::degenerate || worst_rad > 1.0)
      << to_text(found.outcome) << ", deviation about the line " << worst_rad << " rad";
}

TEST(TwoFrameBa, ThirtyPercentOutliersDoNotMoveTheFit) {
  WorldView view = mover(0.1, 0.1);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> off(6, 30);
  for (std::size_t i = 0; i < view.pairs.size(); ++i) {
    if (i % 10 >= 3) continue;
    Eigen::Vector3d z = view.pairs[i].curr.z_px + Eigen::Vector3d(off(random), off(random), off(random) - 18);
    z.z() = std::min(z.z(), z.x() - 5);
    view.pairs[i].curr = {z, kRig.triangulate(z)};
  }
  TransferPoints scored;
  const auto start = propose_motion(kRig, view.pairs, view.all(), 3, {}, scored);
  ASSERT_TRUE(start.has_value());
  const MotionFit found = fit(view, view.all(), *start);
  EXPECT_LT(nees(view.H_curr_prev(1), found), kChi2_6dof_9999);
  EXPECT_GE(found.support, 54);
  EXPECT_LE(found.support, 57);
}

TEST(StereoTransfer, ResidualOfNoiseIsAChiSquareOfThreeDegrees) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const WorldView view = mover(0.25, 0.25, seed);
    for (const PointPair& pair : view.pairs) {
      sum += transfer_chi2(kRig, view.H_curr_prev(1), pair);
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 3.0, 4 * std::sqrt(6.0 / count));
}

TEST(StereoTransfer, APointBehindTheCameraIsImpossible) {
  const WorldView view = mover(0, 0.1);
  const Rigid3 H = Rigid3(Eigen::Translation3d(0, 0, -5));
  EXPECT_GE(transfer_chi2(kRig, H, view.pairs[0]), 1e12);
}

TEST(MotionProposal, IsTheMotionOfTheMajorityAmongMixedPoints) {
  PointWorld world(0);
  world.add_body(30, {0.5, 0, 2.5}, 0.3, twist(0.03, 0, 0, 0, 0.02, 0));
  world.add_body(20, {-0.5, 0, 2.0}, 0.3, twist(0, -0.04, 0, 0, 0, 0));
  const WorldView view = world.observe(2, 0, 0.1);
  TransferPoints scored;
  const auto H = propose_motion(kRig, view.pairs, view.all(), 7, {}, scored);
  ASSERT_TRUE(H.has_value());
  EXPECT_LT(se3_log(*H * view.H_curr_prev(1).inverse()).norm(), 1e-6);
  EXPECT_FALSE(propose_motion(kRig, view.pairs, std::vector<PointIndex>{0, 1}, 7, {}, scored).has_value());
}

TEST(RigidFit, RecoversTheMotionAndRefusesALineAndTwoPoints) {
  const Rigid3 T_b_a = se3_exp(twist(0.3, -0.2, 0.5, 0.4, -1.0, 0.7));
  std::vector<PointMatch> matches;
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 2), Eigen::Vector3d(0, 1, 3), Eigen::Vector3d(1, 1, 1.5)}) {
    matches.push_back({p, T_b_a * p, 1.0});
  }
  const auto found = fit_rigid(matches);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(se3_log(*found * T_b_a.inverse()).norm(), 1e-12);
  // A plane seen from its other side must not be fitted by a reflection.
  EXPECT_NEAR(fit_rigid(std::span(matches).first(3))->linear().determinant(), 1.0, 1e-12);
  EXPECT_FALSE(fit_rigid(std::span(matches).first(2)).has_value());
  std::vector<PointMatch> line;
  for (int i = 0; i < 5; ++i) line.push_back({Eigen::Vector3d(i, 2 * i, 1), T_b_a * Eigen::Vector3d(i, 2 * i, 1), 1.0});
  EXPECT_FALSE(fit_rigid(line).has_value());
}

TEST(RigidFit, AWeightOfZeroTakesAPointOut) {
  const Rigid3 T_b_a = se3_exp(twist(0.3, 0, 0, 0, 0.2, 0));
  std::vector<PointMatch> matches;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d p(i, i * i, 1 + i % 2);
    matches.push_back({p, T_b_a * p, 1.0});
  }
  matches[2].p_b += Eigen::Vector3d(9, 9, 9);
  matches[2].weight = 0;
  EXPECT_LT(se3_log(*fit_rigid(matches) * T_b_a.inverse()).norm(), 1e-12);
}

}  // namespace
}  // namespace pelorus
