// The steps that tell the static scene from what moves in it: paper 5.2 to 5.2.3.

#include <gtest/gtest.h>

#include "core/motion/ray_filter.h"
#include "core/motion/repartition.h"
#include "core/motion/static_group.h"
#include "tests/support/point_world.h"

namespace pelorus {
namespace {

using test::kRig;
using test::PointWorld;
using test::twist;
using test::WorldView;

// A body with 45 % of the points, near the camera, over a part of the view.
WorldView big_body() {
  PointWorld world(400);
  world.add_body(160, {0, 0, 2.0}, 0.6, twist(0.04, 0, 0, 0, 0, 0));
  WorldView view = world.observe(3, 0, 0.1);
  // Keep as many floor points as make the body's share 45 %.
  const auto body = static_cast<double>(view.members(1).size());
  const auto floor = static_cast<std::size_t>(body * 0.55 / 0.45);
  while (view.members(0).size() > floor) {
    view.pairs.erase(view.pairs.begin());
    view.body_of.erase(view.body_of.begin());
  }
  return view;
}

Partition true_partition(const WorldView& view) {
  Partition partition;
  for (int body = 0; body < 2; ++body) {
    Group group;
    group.members = view.members(body);
    group.H_curr_prev = view.H_curr_prev(body);
    partition.groups.push_back(group);
  }
  partition.group_of.assign(view.body_of.begin(), view.body_of.end());
  return partition;
}

void remember_roles(WorldView& view) {
  for (std::size_t i = 0; i < view.pairs.size(); ++i) {
    view.pairs[i].previous_body = view.body_of[i] == 0 ? kWorldBody : BodyId{1};
  }
}

TEST(StaticGroup, ABodyWithNearlyHalfThePointsIsNotTheWorldWhenHistorySaysSo) {
  WorldView view = big_body();
  const Partition partition = true_partition(view);
  remember_roles(view);
  const StaticChoice choice = choose_static_group(kRig, view.pairs, partition, view.H_curr_prev(0), {}, true);
  EXPECT_EQ(choice.group, 0);
  EXPECT_GT(choice.world_confidence, 0.4);
}

TEST(StaticGroup, HistoryOutweighsEvenAMajorityOfThePoints) {
  WorldView view = big_body();
  remember_roles(view);
  const auto floor = static_cast<std::size_t>(static_cast<double>(view.members(1).size()) * 0.4 / 0.6);
  while (view.members(0).size() > floor) {
    view.pairs.erase(view.pairs.begin());
    view.body_of.erase(view.body_of.begin());
  }
  const Partition partition = true_partition(view);
  EXPECT_EQ(choose_static_group(kRig, view.pairs, partition, std::nullopt, {}, true).group, 0);
  // Without the criteria the largest group is the world: the ablation fails where the criteria hold.
  EXPECT_EQ(choose_static_group(kRig, view.pairs, partition, std::nullopt, {}, false).group, 1);
}

TEST(StaticGroup, BetweenTwoAlikeTheMarginIsSmallUntilHistoryTells) {
  PointWorld world(0);
  world.add_body(52, {-0.7, 0, 3.0}, 0.5, twist(0.04, 0, 0, 0, 0, 0));
  world.add_body(48, {0.7, 0, 3.0}, 0.5, twist(0, 0, 0, 0, 0, 0));
  WorldView view = world.observe(3, 0, 0.1);
  Partition partition;
  for (int body = 1; body <= 2; ++body) {
    Group group;
    group.members = view.members(body);
    partition.groups.push_back(group);
  }
  const StaticChoice blind = choose_static_group(kRig, view.pairs, partition, std::nullopt, {}, true);
  EXPECT_LT(blind.world_confidence, 0.1);
  for (const PointIndex i : view.members(1)) view.pairs[static_cast<std::size_t>(i)].previous_body = BodyId{1};
  for (const PointIndex i : view.members(2)) view.pairs[static_cast<std::size_t>(i)].previous_body = kWorldBody;
  const StaticChoice informed = choose_static_group(kRig, view.pairs, partition, std::nullopt, {}, true);
  EXPECT_EQ(informed.group, 1);
  EXPECT_GT(informed.world_confidence, 0.4);
}

TEST(StaticGroup, TheOrderOfTheGroupsDoesNotMatter) {
  const WorldView view = big_body();
  Partition partition = true_partition(view);
  const StaticChoice choice = choose_static_group(kRig, view.pairs, partition, view.H_curr_prev(0), {}, true);
  std::swap(partition.groups[0], partition.groups[1]);
  const StaticChoice swapped = choose_static_group(kRig, view.pairs, partition, view.H_curr_prev(0), {}, true);
  EXPECT_EQ(choice.group, 1 - swapped.group);
  EXPECT_DOUBLE_EQ(choice.world_confidence, swapped.world_confidence);
}

TEST(StaticGroup, NoGroupIsNoWorld) {
  const WorldView view = big_body();
  EXPECT_EQ(choose_static_group(kRig, view.pairs, {}, std::nullopt, {}, true).group, -1);
}

StaticMotions static_motions(const WorldView& view) {
  StaticMotions motions;
  const std::size_t last = view.T_world_cam.size() - 1;
  for (std::size_t j = 0; j <= kPastFrames && j < last; ++j) {
    motions.T_curr_past[j] = view.T_world_cam[last].inverse() * view.T_world_cam[last - 1 - j];
    ++motions.size;
  }
  return motions;
}

TEST(Repartition, FloorIsFixedAndMoversAreMoving) {
  PointWorld world(200);
  world.add_body(40, {0.3, 0, 2.0}, 0.3, twist(0.03, 0.02, 0, 0, 0, 0));
  const WorldView view = world.observe(6, 0.1, 0.1);
  std::vector<PointRole> roles(view.pairs.size(), PointRole::unknown);
  std::vector<double> chi2(view.pairs.size());
  repartition(kRig, view.pairs, static_motions(view), {}, roles, chi2);
  int wrong = 0;
  for (std::size_t i = 0; i < roles.size(); ++i) {
    wrong += roles[i] != (view.body_of[i] == 0 ? PointRole::fixed : PointRole::moving);
  }
  EXPECT_LE(wrong, 2);  // 0.1 % of 200 at each of two strides
}

TEST(Repartition, ASlowMoverShowsOnlyOverTheHistory) {
  PointWorld world(0);
  world.add_body(40, {0, 0, 2.0}, 0.3, twist(0.0025, 0, 0, 0, 0, 0));  // 1 px per frame at 2 m, sigma 0.3 px
  const auto moving = [&](int frames) {
    const WorldView view = world.observe(frames, 0, 0.3);
    std::vector<PointRole> roles(view.pairs.size());
    std::vector<double> chi2(view.pairs.size());
    repartition(kRig, view.pairs, static_motions(view), {}, roles, chi2);
    return std::count(roles.begin(), roles.end(), PointRole::moving);
  };
  EXPECT_EQ(moving(2), 0);
  EXPECT_EQ(moving(6), 40);
}

TEST(Repartition, ABorderlinePointStaysWhatItWas) {
  PointWorld world(0);
  world.add_body(1, {0, 0, 2.0}, 0.01, twist(0.0025, 0, 0, 0, 0, 0));
  WorldView view = world.observe(2, 0, 0.1);
  const StaticMotions motions = static_motions(view);
  const double chi2_at_tenth = static_chi2(kRig, view.pairs[0], motions);
  const auto role_at = [&](double chi2_wanted, BodyId before) {
    view.pairs[0].sigma_px = 0.1 * std::sqrt(chi2_at_tenth / chi2_wanted);
    view.pairs[0].previous_body = before;
    std::array<PointRole, 1> roles{};
    std::array<double, 1> chi2{};
    repartition(kRig, view.pairs, motions, {}, roles, chi2);
    EXPECT_NEAR(chi2[0], chi2_wanted, 1e-6);
    return roles[0];
  };
  EXPECT_EQ(role_at(19, kWorldBody), PointRole::fixed);
  EXPECT_EQ(role_at(19, kNoBody), PointRole::moving);
  EXPECT_EQ(role_at(12, kNoBody), PointRole::fixed);
  EXPECT_EQ(role_at(12, BodyId{1}), PointRole::moving);
  EXPECT_EQ(role_at(5, BodyId{1}), PointRole::fixed);
}

// A net of static points 60 px apart on a plane at 4 m, and one moving point at a given place.
struct NetScene {
  std::vector<PointPair> pairs;
  std::vector<PointRole> roles;
  std::vector<double> chi2;
  StaticNet net{200};

  NetScene() {
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 5; ++column) {
        add({(300 + 60 * column + 7 * (row % 2) - kRig.cx_px) / 200, (200 + 60 * row - kRig.cy_px) / 200, 4.0},
            PointRole::fixed, 0);
      }
    }
  }
  std::size_t add(const Eigen::Vector3d& p, PointRole role, int history) {
    const std::vector<Eigen::Vector3d> z_px(static_cast<std::size_t>(history) + 2, kRig.project(p));
    pairs.push_back(PointWorld::pair_of(z_px, 0.25, TrackId{pairs.size() + 1}));
    roles.push_back(role);
    chi2.push_back(role == PointRole::moving ? 40.0 : 1.0);
    return pairs.size() - 1;
  }
  void build() { net.build(pairs, roles); }
};

bool inside_triangle(const Eigen::Vector2d& p, const std::array<Eigen::Vector2d, 3>& t) {
  int sign = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector2d e = t[(k + 1) % 3] - t[k];
    const Eigen::Vector2d d = p - t[k];
    sign += e.x() * d.y() - e.y() * d.x() > 0 ? 1 : -1;
  }
  return std::abs(sign) == 3;
}

TEST(NetFilter, MarksExactlyTheCornersOfTheTriangleAroundAMovingPoint) {
  NetScene scene;
  const std::size_t mover = scene.add({-0.1, -0.2, 2.0}, PointRole::moving, 0);
  scene.build();
  EXPECT_EQ(net_filter(scene.net, scene.pairs, scene.roles), 3);
  std::array<Eigen::Vector2d, 3> corners;
  std::size_t suspects = 0;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    if (scene.roles[i] == PointRole::suspect) corners.at(suspects++) = scene.pairs[i].curr.z_px.head<2>();
  }
  ASSERT_EQ(suspects, 3U);
  EXPECT_TRUE(inside_triangle(scene.pairs[mover].curr.z_px.head<2>(), corners));
  // Delaunay: a triangle of the grid, so no corner is further than one cell's diagonal.
  for (const auto& corner : corners) EXPECT_LT((corner - scene.pairs[mover].curr.z_px.head<2>()).norm(), 90.0);
  EXPECT_EQ(scene.roles[mover], PointRole::moving);
}

TEST(NetFilter, AMovingPointOutsideTheNetMarksNothing) {
  NetScene scene;
  scene.add({-1.2, 0.9, 2.0}, PointRole::moving, 0);
  scene.build();
  EXPECT_EQ(net_filter(scene.net, scene.pairs, scene.roles), 0);
}

TEST(NetFilter, TwoMovingPointsInOneTriangleCountItsCornersOnce) {
  NetScene scene;
  scene.add({-0.1, -0.2, 2.0}, PointRole::moving, 0);
  scene.add({-0.1005, -0.2, 2.0}, PointRole::moving, 0);
  scene.build();
  EXPECT_EQ(net_filter(scene.net, scene.pairs, scene.roles), 3);
}

TEST(RayFilter, RejectsAMovingPointOnTheSurfaceAndKeepsOneAboveIt) {
  NetScene scene;
  const std::size_t on_surface = scene.add({-0.1, -0.2, 4.01}, PointRole::moving, 0);
  const std::size_t above = scene.add({0.1, -0.1, 3.5}, PointRole::moving, 0);
  const std::size_t outside = scene.add({-2.0, 1.5, 4.0}, PointRole::moving, 0);
  scene.build();
  EXPECT_EQ(ray_filter(kRig, scene.net, scene.pairs, scene.chi2, {}, scene.roles), 1);
  EXPECT_EQ(scene.roles[on_surface], PointRole::outlier);
  EXPECT_EQ(scene.roles[above], PointRole::moving);
  EXPECT_EQ(scene.roles[outside], PointRole::moving);
}

TEST(RayFilter, ABodyThatConclusivelySlidesOnTheSurfaceIsReal) {
  NetScene scene;
  const std::size_t slider = scene.add({-0.1, -0.2, 4.0}, PointRole::moving, 4);
  const std::size_t newcomer = scene.add({0.0, -0.2, 4.0}, PointRole::moving, 1);
  const std::size_t doubtful = scene.add({0.1, -0.2, 4.0}, PointRole::moving, 4);
  const std::size_t known = scene.add({0.2, -0.2, 4.0}, PointRole::moving, 1);
  scene.pairs[known].previous_body = BodyId{3};
  scene.chi2[slider] = scene.chi2[newcomer] = 120;
  scene.build();
  EXPECT_EQ(ray_filter(kRig, scene.net, scene.pairs, scene.chi2, {}, scene.roles), 2);
  EXPECT_EQ(scene.roles[slider], PointRole::moving);
  EXPECT_EQ(scene.roles[newcomer], PointRole::outlier);
  EXPECT_EQ(scene.roles[doubtful], PointRole::outlier);
  EXPECT_EQ(scene.roles[known], PointRole::moving);
}

}  // namespace
}  // namespace pelorus
