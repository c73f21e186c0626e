#include "core/geometry/delaunay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "core/geometry/hull.h"

namespace pelorus {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points random_points(std::mt19937& rng, int count, double width = 1024, double height = 768) {
  std::uniform_real_distribution<double> u(0, width);
  std::uniform_real_distribution<double> v(0, height);
  Points points;
  for (int i = 0; i < count; ++i) points.emplace_back(u(rng), v(rng));
  return points;
}

Points lattice(int columns, int rows, double step) {
  Points points;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) points.emplace_back(c * step, r * step);
  }
  return points;
}

double area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
}

double area(const Points& points, const Triangle& t) {
  const auto corner = [&](std::size_t i) { return points[static_cast<std::size_t>(t.vertices[i])]; };
  return area(corner(0), corner(1), corner(2));
}

double net_area(const Points& points, const Delaunay& net) {
  double sum = 0;
  for (const Triangle& t : net.triangles()) sum += area(points, t);
  return sum;
}

double hull_area(const Points& points) {
  Points outline(points.size() + 4);
  const int size = convex_outline(points, outline);
  double sum = 0;
  for (std::size_t i = 2; i < static_cast<std::size_t>(size); ++i) sum += area(outline[0], outline[i - 1], outline[i]);
  return sum;
}

// Places, not indices, so that nets of shuffled points compare.
std::set<std::vector<std::pair<double, double>>> triangle_places(const Points& points, const Delaunay& net) {
  std::set<std::vector<std::pair<double, double>>> places;
  for (const Triangle& t : net.triangles()) {
    std::vector<std::pair<double, double>> corners;
    for (int v : t.vertices) {
      const Eigen::Vector2d& p = points[static_cast<std::size_t>(v)];
      corners.emplace_back(p.x(), p.y());
    }
    std::sort(corners.begin(), corners.end());
    places.insert(corners);
  }
  return places;
}

// How far the deepest point lies inside the circumcircle of a triangle it is not a corner of; <= 0 for Delaunay.
double worst_intrusion(const Points& points, const Delaunay& net) {
  double worst = -HUGE_VAL;
  for (const Triangle& t : net.triangles()) {
    const Eigen::Vector2d a = points[static_cast<std::size_t>(t.vertices[0])];
    const Eigen::Vector2d b = points[static_cast<std::size_t>(t.vertices[1])] - a;
    const Eigen::Vector2d c = points[static_cast<std::size_t>(t.vertices[2])] - a;
    const double d = 2 * (b.x() * c.y() - b.y() * c.x());
    const Eigen::Vector2d offset(c.y() * b.squaredNorm() - b.y() * c.squaredNorm(),
                                 b.x() * c.squaredNorm() - c.x() * b.squaredNorm());
    const Eigen::Vector2d center = a + offset / d;
    for (const Eigen::Vector2d& p : points) worst = std::max(worst, (a - center).norm() - (p - center).norm());
  }
  return worst;
}

TEST(Delaunay, NoPointLiesInsideACircumcircle) {
  std::mt19937 rng(1);
  Delaunay net(600);
  for (int count : {3, 4, 5, 10, 50, 200, 600}) {
    const Points points = random_points(rng, count);
    ASSERT_TRUE(net.run(points));
    // The points themselves are on the circles; slivers along the hull have circles of 1e6 px and more.
    EXPECT_LT(worst_intrusion(points, net), 1e-4) << count << " points";
  }
}

TEST(Delaunay, TrianglesCoverTheHullOnce) {
  std::mt19937 rng(2);
  Delaunay net(600);
  for (int count : {3, 4, 7, 30, 600}) {
    const Points points = random_points(rng, count);
    ASSERT_TRUE(net.run(points));
    EXPECT_NEAR(net_area(points, net), hull_area(points), 1e-6 * hull_area(points));
    for (const Triangle& t : net.triangles()) EXPECT_GT(area(points, t), -1e-3);
  }
}

TEST(Delaunay, NumberOfTrianglesFollowsEulersFormula) {
  std::mt19937 rng(3);
  Points points = random_points(rng, 300, 900, 600);
  for (const auto& corner :
       {Eigen::Vector2d(-1, -1), Eigen::Vector2d(901, -1), Eigen::Vector2d(901, 601), Eigen::Vector2d(-1, 601)}) {
    points.push_back(corner);  // so that the hull has four vertices
  }
  Delaunay net(304);
  ASSERT_TRUE(net.run(points));
  EXPECT_EQ(net.triangles().size(), 2 * points.size() - 2 - 4);
}

TEST(Delaunay, OrderOfPointsDoesNotChangeTheNet) {
  std::mt19937 rng(4);
  Delaunay net(400);
  for (Points points : {random_points(rng, 400), lattice(20, 20, 16)}) {
    ASSERT_TRUE(net.run(points));
    const auto before = triangle_places(points, net);
    for (int round = 0; round < 5; ++round) {
      std::shuffle(points.begin(), points.end(), rng);
      ASSERT_TRUE(net.run(points));
      EXPECT_EQ(triangle_places(points, net), before);
    }
  }
}

TEST(Delaunay, LatticeOfCocircularPointsIsCovered) {
  const Points points = lattice(17, 13, 8);
  Delaunay net(static_cast<int>(points.size()));
  ASSERT_TRUE(net.run(points));
  EXPECT_EQ(net.triangles().size(), 2U * 16U * 12U);
  EXPECT_DOUBLE_EQ(net_area(points, net), 16 * 8 * 12 * 8.0);
  for (const Triangle& t : net.triangles()) EXPECT_DOUBLE_EQ(area(points, t), 32.0);
}

// Points on edges of the hull, in any order of arrival: a lattice turned by a whole-numbered matrix stays exact.
TEST(Delaunay, TurnedLatticesHaveNoFlatTriangle) {
  Points square = lattice(12, 12, 1);
  Delaunay net(144);
  for (const auto& [p, q] : {std::pair{1, 1}, {2, 1}, {-3, 1}, {5, -2}, {-7, -4}}) {
    Eigen::Matrix2d turn;
    turn << p, -q, q, p;
    Points points;
    for (const Eigen::Vector2d& corner : square) points.push_back(turn * corner);
    ASSERT_TRUE(net.run(points));
    EXPECT_EQ(net.triangles().size(), 2U * 11U * 11U);
    for (const Triangle& t : net.triangles()) EXPECT_DOUBLE_EQ(area(points, t), 0.5 * (p * p + q * q));
  }
}

TEST(Delaunay, PointsWithoutATriangleAreRefused) {
  Delaunay net(10);
  EXPECT_FALSE(net.run({}));
  EXPECT_FALSE(net.run(Points{{1, 2}}));
  EXPECT_FALSE(net.run(Points{{1, 2}, {3, 4}}));
  EXPECT_FALSE(net.run(Points{{1, 2}, {1, 2}, {1, 2}, {1, 2}}));
  EXPECT_FALSE(net.run(Points{{0, 0}, {1, 1}, {2, 2}, {3, 3}, {3, 3}}));
  EXPECT_FALSE(net.run(Points{{0, 0}, {1, 1}, {NAN, 0}, {0, INFINITY}}));
  EXPECT_TRUE(net.triangles().empty());
  EXPECT_EQ(net.find({1, 1}), -1);
}

TEST(Delaunay, ARefusedRunLeavesNoTrianglesOfTheRunBefore) {
  Delaunay net(10);
  ASSERT_TRUE(net.run(Points{{0, 0}, {4, 0}, {0, 4}}));
  EXPECT_FALSE(net.run(Points{{0, 0}, {4, 0}}));
  EXPECT_TRUE(net.triangles().empty());
}

TEST(Delaunay, DuplicatesAndInvalidPointsAreSkipped) {
  std::mt19937 rng(5);
  const Points distinct = random_points(rng, 100);
  Points points = distinct;
  points.insert(points.end(), distinct.begin(), distinct.end());
  points.emplace_back(NAN, 1);
  points.emplace_back(1, -INFINITY);
  Delaunay net(300);
  ASSERT_TRUE(net.run(distinct));
  const auto expected = triangle_places(distinct, net);
  ASSERT_TRUE(net.run(points));
  EXPECT_EQ(triangle_places(points, net), expected);
  for (const Triangle& t : net.triangles()) {
    for (int v : t.vertices) EXPECT_LT(v, 100) << "the first of equal points is the vertex";
  }
}

TEST(Delaunay, MostPointsOnOneLineStillGiveAFan) {
  Points points;
  for (int i = 0; i < 50; ++i) points.emplace_back(i, 7);
  points.emplace_back(25, 30);
  Delaunay net(51);
  ASSERT_TRUE(net.run(points));
  EXPECT_EQ(net.triangles().size(), 49U);
  EXPECT_DOUBLE_EQ(net_area(points, net), 0.5 * 49 * 23);
}

TEST(Delaunay, FoundTriangleHoldsThePoint) {
  std::mt19937 rng(6);
  const Points points = random_points(rng, 300);
  Delaunay net(300);
  ASSERT_TRUE(net.run(points));
  for (const Eigen::Vector2d& p : random_points(rng, 2000, 1100, 800)) {
    int holding = -1;
    double depth = -HUGE_VAL;  // of p in the triangle that holds it best [px^2]
    for (std::size_t i = 0; i < net.triangles().size(); ++i) {
      const auto& v = net.triangles()[i].vertices;
      const Eigen::Vector2d& a = points[static_cast<std::size_t>(v[0])];
      const Eigen::Vector2d& b = points[static_cast<std::size_t>(v[1])];
      const Eigen::Vector2d& c = points[static_cast<std::size_t>(v[2])];
      const double inside = std::min({area(a, b, p), area(b, c, p), area(c, a, p)});
      if (inside > depth) {
        depth = inside;
        holding = static_cast<int>(i);
      }
    }
    if (std::abs(depth) < 1e-2) continue;  // on an edge: two right answers
    EXPECT_EQ(net.find(p), depth > 0 ? holding : -1) << p.transpose();
  }
}

TEST(Delaunay, EveryVertexIsFoundInATriangleOfItsOwn) {
  const Points points = lattice(9, 9, 5);
  Delaunay net(81);
  ASSERT_TRUE(net.run(points));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int found = net.find(points[i]);
    ASSERT_GE(found, 0);
    const auto& v = net.triangles()[static_cast<std::size_t>(found)].vertices;
    EXPECT_NE(std::find(v.begin(), v.end(), static_cast<int>(i)), v.end());
  }
}

TEST(Delaunay, PointsFarOutsideOrNotFiniteAreInNoTriangle) {
  Delaunay net(4);
  ASSERT_TRUE(net.run(Points{{0, 0}, {4, 0}, {0, 4}, {4, 4}}));
  for (const Eigen::Vector2d& p : Points{{-1, 2}, {2, 4.001}, {1e300, 0}, {NAN, 1}, {1, INFINITY}}) {
    EXPECT_EQ(net.find(p), -1);
  }
}

}  // namespace
}  // namespace pelorus
