#include "core/motion/grouping.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/motion/rigidity.h"
#include "tests/support/point_world.h"

namespace pelorus {
namespace {

using test::kRig;
using test::PointWorld;
using test::twist;
using test::WorldView;

constexpr double kNoise_px = 0.1;
constexpr double kChi2_6dof_9999 = 27.86;

Partition group(const WorldView& view, const Grouping::Options& options = {}) {
  Grouping grouping({}, {}, {}, 1000);
  return grouping.run(kRig, view.pairs, view.all(), {}, 1, options);
}

PointWorld two_movers() {
  PointWorld world(250);
  world.add_body(40, {-0.6, -0.2, 2.2}, 0.25, twist(0.04, 0.01, 0, 0, 0.02, 0.01));
  world.add_body(40, {0.7, 0.2, 2.0}, 0.25, twist(-0.02, -0.03, 0.02, 0.02, 0, -0.03));
  return world;
}

// The body that most members of a group belong to.
int body_of(const WorldView& view, const Group& group) {
  std::array<int, 3> votes{};
  for (const PointIndex i : group.members) {
    ++votes[static_cast<std::size_t>(view.body_of[static_cast<std::size_t>(i)])];
  }
  return static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

int points_in_wrong_groups(const WorldView& view, const Partition& partition) {
  int wrong = 0;
  for (const Group& g : partition.groups) {
    const int body = body_of(view, g);
    for (const PointIndex i : g.members) wrong += view.body_of[static_cast<std::size_t>(i)] != body;
  }
  return wrong;
}

void expect_true_motions(const WorldView& view, const Partition& partition) {
  for (const Group& g : partition.groups) {
    const Rigid3 H_true = view.H_curr_prev(body_of(view, g));
    const Vector6d xi = se3_log(H_true * g.H_curr_prev.inverse());
    EXPECT_LT(xi.dot(g.cov_H.inverse() * xi), kChi2_6dof_9999);
    // Independent of the stated covariance: the mean of n points is known n times better than one.
    const double sigma_px = kNoise_px * std::sqrt(2.0 * 3.0 / static_cast<double>(g.members.size()));
    EXPECT_LT(test::image_error_px(view, g.members, g.H_curr_prev, H_true), 4 * sigma_px);
  }
}

TEST(Grouping, AllStaticIsOneGroupThatDoesNotMoveInTheWorld) {
  const WorldView view = PointWorld(250).observe(6, kNoise_px, kNoise_px);
  const Partition partition = group(view);
  ASSERT_EQ(partition.groups.size(), 1U);
  // 99.9 % gate: a point or two of 250 may be called an outlier.
  EXPECT_GE(partition.groups[0].members.size() + 3, view.pairs.size());
  expect_true_motions(view, partition);
  const Rigid3 M = view.T_world_cam.back() * partition.groups[0].H_curr_prev * view.T_world_cam[4].inverse();
  EXPECT_LT(M.translation().norm(), 0.01);
  EXPECT_LT(rotation_angle_rad(M.linear()), 0.002);
}

TEST(Grouping, FloorAndTwoMoversAreThreeGroupsWithoutAWrongPoint) {
  const WorldView view = two_movers().observe(6, kNoise_px, kNoise_px);
  const Partition partition = group(view);
  ASSERT_EQ(partition.groups.size(), 3U);
  EXPECT_EQ(points_in_wrong_groups(view, partition), 0);
  std::size_t grouped = 0;
  for (const Group& g : partition.groups) grouped += g.members.size();
  EXPECT_GE(grouped + 4, view.pairs.size());
  expect_true_motions(view, partition);
}

TEST(Grouping, GroupOfAndMembersTellTheSame) {
  const WorldView view = two_movers().observe(6, kNoise_px, kNoise_px);
  const Partition partition = group(view);
  std::vector<std::int32_t> from_members(view.pairs.size(), -1);
  for (std::size_t g = 0; g < partition.groups.size(); ++g) {
    const auto& members = partition.groups[g].members;
    EXPECT_TRUE(std::is_sorted(members.begin(), members.end()));
    for (const PointIndex i : members) from_members[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(g);
  }
  EXPECT_EQ(from_members, partition.group_of);
}

// A motion may explain its points so well that it comes first, though they are too few for a group.
TEST(Grouping, AMotionOfTooFewPointsDoesNotEndTheSearch) {
  PointWorld world(150);
  world.add_body(13, {-0.6, -0.2, 2.2}, 0.25, twist(0.04, 0.01, 0, 0, 0.02, 0.01));
  world.add_body(20, {0.7, 0.2, 2.0}, 0.25, twist(-0.02, -0.03, 0.02, 0.02, 0, -0.03));
  WorldView view = world.observe(6, kNoise_px, kNoise_px);
  for (std::size_t i = 0; i < view.pairs.size(); ++i) {
    if (view.body_of[i] == 2) view.pairs[i].sigma_px /= std::sqrt(3.0);  // explained, but none of them well
  }
  GroupingConfig config;
  config.min_group_points = 14;
  Grouping grouping(config, {}, {}, 1000);
  const std::vector<Rigid3> priors{view.H_curr_prev(1), view.H_curr_prev(2)};
  const Partition& partition = grouping.run(kRig, view.pairs, view.all(), priors, 1, {});
  ASSERT_EQ(partition.groups.size(), 2U);
  EXPECT_EQ(body_of(view, partition.groups[1]), 2);
}

TEST(Grouping, AMoverWithTheImageMotionOfTheFloorStillSplits) {
  // Half as far, it moves with half the camera's shift: the same flow in both images, at another depth.
  PointWorld world(0);
  world.twist_cam = twist(0.06, 0, 0, 0, 0, 0);
  world.add_body(200, {0, 0, 4.0}, 1.2, twist(0, 0, 0, 0, 0, 0));
  world.add_body(40, {0.1, 0.1, 2.0}, 0.15, twist(0.03, 0, 0, 0, 0, 0));
  const WorldView view = world.observe(6, kNoise_px, kNoise_px);
  const Eigen::Vector2d flow_body =
      kRig.project(view.H_curr_prev(2) * Eigen::Vector3d(0, 0, 2)).head<2>() - kRig.project({0, 0, 2}).head<2>();
  const Eigen::Vector2d flow_floor =
      kRig.project(view.H_curr_prev(1) * Eigen::Vector3d(0, 0, 4)).head<2>() - kRig.project({0, 0, 4}).head<2>();
  ASSERT_LT((flow_body - flow_floor).norm(), 1e-6);
  const Partition partition = group(view);
  ASSERT_EQ(partition.groups.size(), 2U);
  EXPECT_LE(points_in_wrong_groups(view, partition), 1);
}

TEST(Grouping, AnotherWorldFrameGivesTheSameGroupsAndTheSameMotionInIt) {
  PointWorld world = two_movers();
  const WorldView view = world.observe(6, kNoise_px, kNoise_px);
  const Rigid3 T_new_old = se3_exp(twist(30, -20, 5, 0.5, -1.0, 2.0));
  world.move_world(T_new_old);
  const WorldView moved = world.observe(6, kNoise_px, kNoise_px);
  const Partition before = group(view);
  const Partition after = group(moved);
  ASSERT_EQ(before.group_of, after.group_of);
  const auto M_world = [](const WorldView& v, const Group& g) {
    return Rigid3(v.T_world_cam.back() * g.H_curr_prev * v.T_world_cam[4].inverse());
  };
  for (std::size_t g = 0; g < before.groups.size(); ++g) {
    const Rigid3 M_expected = T_new_old * M_world(view, before.groups[g]) * T_new_old.inverse();
    EXPECT_TRUE(M_world(moved, after.groups[g]).isApprox(M_expected, 1e-6));
  }
}

TEST(Grouping, ShuffledPointsGiveTheSamePartition) {
  const WorldView view = two_movers().observe(6, kNoise_px, kNoise_px);
  const Partition before = group(view);
  std::vector<std::size_t> order(view.pairs.size());
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
  WorldView shuffled = view;
  for (std::size_t i = 0; i < order.size(); ++i) shuffled.pairs[i] = view.pairs[order[i]];
  const Partition after = group(shuffled);
  ASSERT_EQ(before.groups.size(), after.groups.size());
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(after.group_of[i], before.group_of[order[i]]);
}

TEST(Grouping, SamePointsGiveTheSameResultTwice) {
  const WorldView view = two_movers().observe(6, kNoise_px, kNoise_px);
  Grouping grouping({}, {}, {}, 1000);
  const Partition first = grouping.run(kRig, view.pairs, view.all(), {}, 1, {});
  (void)grouping.run(kRig, PointWorld(40).observe(3, 0, 0.1).pairs, std::vector<PointIndex>{1, 2, 3, 4, 5, 6, 7}, {}, 9,
                     {});
  const Partition again = grouping.run(kRig, view.pairs, view.all(), {}, 1, {});
  ASSERT_EQ(first.group_of, again.group_of);
  for (std::size_t g = 0; g < first.groups.size(); ++g) {
    EXPECT_EQ(first.groups[g].H_curr_prev.matrix(), again.groups[g].H_curr_prev.matrix());
  }
}

TEST(Grouping, AblationsMixNoBodies) {
  const WorldView view = two_movers().observe(6, kNoise_px, kNoise_px);
  const Partition claimed = group(view, {true, false});
  EXPECT_EQ(claimed.groups.size(), 3U);
  EXPECT_LE(points_in_wrong_groups(view, claimed), 2);
  // Samples over all points rarely hit a small body three times: the floor is found, and nothing false.
  const Partition sampled = group(view, {false, true});
  ASSERT_GE(sampled.groups.size(), 1U);
  EXPECT_LE(points_in_wrong_groups(view, sampled), 1);
}

TEST(Grouping, MismatchesBelongToNoGroup) {
  WorldView view = two_movers().observe(6, kNoise_px, kNoise_px);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> off(5, 25);
  for (std::size_t i = 0; i < view.pairs.size(); i += 10) {
    Eigen::Vector3d z = view.pairs[i].curr.z_px;
    z.y() += (i % 20 == 0 ? 1 : -1) * off(random);
    view.pairs[i].curr = {z, kRig.triangulate(z)};
  }
  const Partition partition = group(view);
  ASSERT_GE(partition.groups.size(), 3U);
  int in_groups = 0;
  for (std::size_t i = 0; i < view.pairs.size(); i += 10) {
    in_groups += partition.group_of[i] >= 0 && partition.group_of[i] < 3;
  }
  EXPECT_LE(in_groups, 1);
}

TEST(Grouping, TooFewPointsAreNoGroup) {
  const WorldView view = PointWorld(60).observe(2, 0, 0.1);
  Grouping grouping({}, {}, {}, 100);
  const Partition& partition = grouping.run(kRig, view.pairs, std::vector<PointIndex>{0, 1, 2, 3}, {}, 1, {});
  EXPECT_TRUE(partition.groups.empty());
  EXPECT_EQ(partition.group_of, std::vector<std::int32_t>(view.pairs.size(), -1));
}

TEST(Rigidity, PointsOfOneBodyKeepTheirDistanceAndThoseOfTwoDoNot) {
  PointWorld world(0);
  world.add_body(20, {-0.4, 0, 2.0}, 0.25, twist(0.03, 0, 0, 0, 0, 0));
  world.add_body(20, {0.4, 0, 2.0}, 0.25, twist(-0.03, 0, 0.01, 0, 0, 0));
  const WorldView view = world.observe(6, 0.25, 0.25);
  int same_cut = 0, same = 0, cross_cut = 0, cross = 0;
  for (std::size_t a = 0; a < view.pairs.size(); ++a) {
    for (std::size_t b = a + 1; b < view.pairs.size(); ++b) {
      const RigidityEvidence evidence = rigidity(history_of(kRig, view.pairs[a]), history_of(kRig, view.pairs[b]));
      const bool cut = evidence.change_m > 3 * evidence.sigma_m;
      const bool one = view.body_of[a] == view.body_of[b];
      (one ? same : cross) += 1;
      (one ? same_cut : cross_cut) += cut;
    }
  }
  // 3 sigma, the worse of two strides: 2 * 0.27 % of same-body pairs; pairs share points, hence the factor.
  EXPECT_LT(same_cut, 0.02 * same);
  EXPECT_GT(cross_cut, 0.9 * cross);
}

TEST(Rigidity, HistoryFindsWhatOneStepCannot) {
  PointWorld world(0);
  world.add_body(20, {-0.4, 0, 2.0}, 0.2, twist(0.004, 0, 0, 0, 0, 0));
  world.add_body(20, {0.4, 0, 2.0}, 0.2, twist(-0.004, 0, 0, 0, 0, 0));
  const auto significance = [&](int frames) {
    const WorldView view = world.observe(frames, 0, 0.25);
    const RigidityEvidence evidence =
        rigidity(history_of(kRig, view.pairs.front()), history_of(kRig, view.pairs.back()));
    return evidence.change_m / evidence.sigma_m;
  };
  EXPECT_NEAR(significance(6) / significance(2), 5.0, 0.5);
}

TEST(SeedPoints, OnePerOccupiedCellAndTheBestMatchedOfEqualDensity) {
  WorldView view = PointWorld(300).observe(2, 0, 0.1);
  for (PointPair& pair : view.pairs) pair.match_error = 0.5;
  view.pairs[17].match_error = 0.0;
  SeedPoints seed_points({}, 100);
  const auto all = view.all();
  const auto seeds = seed_points.run(kRig, view.pairs, all);
  EXPECT_LE(seeds.size(), 48U);
  EXPECT_GE(seeds.size(), 30U);
  EXPECT_NE(std::find(seeds.begin(), seeds.end(), 17), seeds.end());
}

}  // namespace
}  // namespace pelorus
