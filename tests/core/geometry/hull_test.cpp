#include "core/geometry/hull.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace pelorus {
namespace {

using Points2 = std::vector<Eigen::Vector2d>;
using Points3 = std::vector<Eigen::Vector3d>;

Eigen::Vector3d random_point(std::mt19937& rng, double scale) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  return {uniform(rng), uniform(rng), uniform(rng)};
}

Points3 random_cloud(std::mt19937& rng, int count) {
  Points3 points;
  for (int i = 0; i < count; ++i) points.push_back(random_point(rng, 1));
  return points;
}

// True when p is on the inner side of every plane through three points that has all other points on one side.
bool inside_all_half_spaces(const Points3& points, const Eigen::Vector3d& p) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const Eigen::Vector3d normal = (points[j] - points[i]).cross(points[k] - points[i]);
        double low = 0;
        double high = 0;
        for (const Eigen::Vector3d& other : points) {
          low = std::min(low, normal.dot(other - points[i]));
          high = std::max(high, normal.dot(other - points[i]));
        }
        const double side = normal.dot(p - points[i]);
        if (high < 1e-9 && side > 0) return false;
        if (low > -1e-9 && side < 0) return false;
      }
    }
  }
  return true;
}

// Distance to the nearest of all segments and triangles between the points: that to the hull for a point outside.
double distance_to_faces(const Points3& points, const Eigen::Vector3d& p) {
  double best = HUGE_VAL;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Eigen::Vector3d ab = points[j] - points[i];
      const double along = i == j ? 0 : std::clamp((p - points[i]).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
      best = std::min(best, (points[i] + along * ab - p).norm());
      for (std::size_t k = 0; k < points.size(); ++k) {
        if (i == j || j == k || i == k) continue;
        Eigen::Matrix<double, 3, 2> edges;
        edges << ab, points[k] - points[i];
        const Eigen::Vector2d weights = (edges.transpose() * edges).inverse() * (edges.transpose() * (p - points[i]));
        if (weights.minCoeff() < 0 || weights.sum() > 1) continue;
        best = std::min(best, (points[i] + edges * weights - p).norm());
      }
    }
  }
  return best;
}

TEST(HullDistance, MatchesTheBoxFormula) {
  std::mt19937 rng(1);
  const Eigen::Vector3d half(0.3, 0.5, 0.8);
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(0.5, 0.1, -0.7, 0.3).normalized();
  Points3 corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    corners.push_back(rotation * sign.cwiseProduct(half));
  }
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p = random_point(rng, 1.5);
    const double expected = (p.cwiseAbs() - half).cwiseMax(0).norm();
    EXPECT_NEAR(distance_to_hull(corners, rotation * p), expected, 1e-9) << p.transpose();
  }
}

TEST(HullDistance, MatchesAllFacesOfRandomClouds) {
  std::mt19937 rng(2);
  for (int round = 0; round < 60; ++round) {
    const Points3 points = random_cloud(rng, 4 + round % 8);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d p = random_point(rng, 1.5);
      const double expected = inside_all_half_spaces(points, p) ? 0 : distance_to_faces(points, p);
      EXPECT_NEAR(distance_to_hull(points, p), expected, 1e-9) << points.size() << " points";
    }
  }
}

TEST(HullDistance, IsZeroAtEveryPointAndMixtureOfThem) {
  std::mt19937 rng(3);
  const Points3 points = random_cloud(rng, 100);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& q = points[(i * 37 + 11) % points.size()];
    const double weight = uniform(rng);
    EXPECT_LT(distance_to_hull(points, points[i]), 1e-9);
    EXPECT_LT(distance_to_hull(points, weight * points[i] + (1 - weight) * q), 1e-9);
  }
}

TEST(HullDistance, FlatSetsMeasureLikeTheirPlaneLineOrPoint) {
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(0.2, 0.9, 0.3, -0.4).normalized();
  Points3 square;
  for (int i = 0; i < 11; ++i) {
    for (int j = 0; j < 11; ++j) square.push_back(rotation * Eigen::Vector3d(0.1 * i, 0.1 * j, 4));
  }
  EXPECT_NEAR(distance_to_hull(square, rotation * Eigen::Vector3d(0.53, 0.47, 4.25)), 0.25, 1e-9);
  EXPECT_NEAR(distance_to_hull(square, rotation * Eigen::Vector3d(0.53, 0.47, 3.9)), 0.1, 1e-9);
  EXPECT_NEAR(distance_to_hull(square, rotation * Eigen::Vector3d(1.3, 0.47, 4.4)), 0.5, 1e-9);
  EXPECT_NEAR(distance_to_hull(square, rotation * Eigen::Vector3d(0.53, 0.47, 4)), 0, 1e-9);
  const Points3 line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}};
  EXPECT_NEAR(distance_to_hull(line, {1.5, 3, 4}), 5, 1e-9);
  EXPECT_NEAR(distance_to_hull(line, {5, 0, 4}), 5, 1e-9);
  EXPECT_NEAR(distance_to_hull(Points3{{1, 2, 3}, {1, 2, 3}}, {1, 2, 5}), 2, 1e-12);
  EXPECT_EQ(distance_to_hull({}, {1, 2, 5}), HUGE_VAL);
}

TEST(HullDistance, DoesNotDependOnTheOrderOfPointsOrOnAShift) {
  std::mt19937 rng(4);
  Points3 points = random_cloud(rng, 60);
  const Eigen::Vector3d p(1.2, 0.7, -0.1);
  const double before = distance_to_hull(points, p);
  ASSERT_GT(before, 0.1);
  std::shuffle(points.begin(), points.end(), rng);
  EXPECT_NEAR(distance_to_hull(points, p), before, 1e-9);
  const Eigen::Vector3d shift(40, -20, 7);
  for (Eigen::Vector3d& point : points) point += shift;
  EXPECT_NEAR(distance_to_hull(points, p + shift), before, 1e-9);
}

double outline_area(const Points2& outline, int size) {
  double sum = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % static_cast<std::size_t>(size)];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

TEST(ConvexOutline, OfASquareWithInnerAndBorderPointsIsTheSquare) {
  Points2 points{{5, 5}, {0, 0}, {10, 0}, {5, 0}, {10, 10}, {0, 10}, {0, 5}, {3, 8}, {10, 10}};
  std::mt19937 rng(5);
  for (int round = 0; round < 10; ++round) {
    Points2 outline(16);
    ASSERT_EQ(convex_outline(points, outline), 4);
    EXPECT_DOUBLE_EQ(outline_area(outline, 4), 100);
    std::shuffle(points.begin(), points.end(), rng);
  }
}

TEST(ConvexOutline, EnclosesAllPointsWithFewVertices) {
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  Points2 circle;
  for (int i = 0; i < 400; ++i) {
    const double a = angle(rng);
    circle.emplace_back(300 + 50 * std::cos(a), 200 + 80 * std::sin(a));
  }
  Points2 outline(16);
  const int size = convex_outline(circle, outline);
  ASSERT_EQ(size, 16);
  for (const Eigen::Vector2d& p : circle) EXPECT_TRUE(inside_outline(outline, p, 1e-9));
  // A regular polygon of 16 sides around a circle has 1.3 % more area; the ellipse stays near that.
  const double area = std::numbers::pi * 50 * 80;
  EXPECT_GT(outline_area(outline, size), 0.99 * area);
  EXPECT_LT(outline_area(outline, size), 1.03 * area);
}

TEST(ConvexOutline, OfTooFewPlacesHasOneOrTwoVertices) {
  Points2 outline(8);
  EXPECT_EQ(convex_outline({}, outline), 0);
  EXPECT_EQ(convex_outline(Points2{{2, 3}, {2, 3}}, outline), 1);
  EXPECT_EQ(convex_outline(Points2{{2, 3}, {4, 5}, {3, 4}, {2, 3}}, outline), 2);
}

TEST(InsideOutline, FollowsTheSidesAndTheMargin) {
  const Points2 outline{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  EXPECT_TRUE(inside_outline(outline, {5, 5}));
  EXPECT_TRUE(inside_outline(outline, {0, 5}));
  EXPECT_FALSE(inside_outline(outline, {-0.1, 5}));
  EXPECT_TRUE(inside_outline(outline, {-0.1, 5}, 0.2));
  EXPECT_FALSE(inside_outline(outline, {-0.3, 5}, 0.2));
  EXPECT_FALSE(inside_outline(outline, {0.1, 5}, -0.2)) << "a negative margin draws the outline in";
  EXPECT_FALSE(inside_outline(std::span(outline).first(2), {5, 0}));
}

}  // namespace
}  // namespace pelorus
