#include "core/frontend/surf_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace pelorus {
namespace {

struct Set {
  std::vector<SurfPoint> points;
  std::vector<SurfDescriptor> descriptors;

  void add(float u, float v, const SurfDescriptor& d, std::int8_t laplacian = 1) {
    SurfPoint p;
    p.u_px = u, p.v_px = v, p.laplacian = laplacian;
    points.push_back(p);
    descriptors.push_back(d);
  }
};

SurfDescriptor unit(SurfDescriptor d) {
  float square = 0;
  for (const float x : d) square += x * x;
  for (float& x : d) x /= std::sqrt(square);
  return d;
}

SurfDescriptor random_descriptor(std::mt19937& rng) {
  std::normal_distribution<float> gauss;
  SurfDescriptor d;
  for (float& x : d) x = gauss(rng);
  return unit(d);
}

SurfDescriptor near(const SurfDescriptor& d, float noise, std::mt19937& rng) {
  std::normal_distribution<float> gauss(0.0F, noise);
  SurfDescriptor n = d;
  for (float& x : n) x += gauss(rng);
  return unit(n);
}

auto matches_of(SurfMatcher& matcher, const Set& a, const Set& b, float radius_px = kAnywhere_px) {
  const auto found = matcher.match(a.points, a.descriptors, b.points, b.descriptors, radius_px);
  return std::vector<SurfMatch>(found.begin(), found.end());
}

TEST(SurfMatch, ShuffledNoisyCopiesFindTheirOriginals) {
  std::mt19937 rng(1);
  Set a;
  Set b;
  for (int i = 0; i < 50; ++i) a.add(static_cast<float>(i), 0, random_descriptor(rng));
  for (int i = 0; i < 50; ++i) {
    b.add(static_cast<float>(i), 0, near(a.descriptors[static_cast<std::size_t>((i * 7) % 50)], 0.02F, rng));
  }
  SurfMatcher matcher({});
  const auto matches = matches_of(matcher, a, b);
  ASSERT_EQ(matches.size(), 50U);
  for (const SurfMatch& m : matches) EXPECT_EQ((m.second * 7) % 50, m.first);
}

TEST(SurfMatch, SwappingTheSetsSwapsThePairs) {
  std::mt19937 rng(2);
  Set a;
  Set b;
  for (int i = 0; i < 40; ++i) a.add(0, 0, random_descriptor(rng));
  for (int i = 0; i < 30; ++i) b.add(0, 0, near(a.descriptors[static_cast<std::size_t>(i)], 0.1F, rng));
  SurfMatcher matcher({});
  const auto there = matches_of(matcher, a, b);
  const auto back = matches_of(matcher, b, a);
  ASSERT_EQ(there.size(), back.size());
  for (const SurfMatch& m : there) {
    EXPECT_TRUE(std::any_of(back.begin(), back.end(),
                            [&](const SurfMatch& r) { return r.first == m.second && r.second == m.first; }));
  }
}

TEST(SurfMatch, TwoLookAlikesOnEitherSideAreRefused) {
  std::mt19937 rng(3);
  const SurfDescriptor d = random_descriptor(rng);
  Set one;
  one.add(0, 0, d);
  Set two;
  two.add(0, 0, near(d, 0.02F, rng));
  two.add(50, 0, near(d, 0.02F, rng));
  SurfMatcher matcher({});
  EXPECT_TRUE(matches_of(matcher, one, two).empty());
  EXPECT_TRUE(matches_of(matcher, two, one).empty());
  Set same;
  same.add(0, 0, d);
  same.add(1, 0, d);
  EXPECT_TRUE(matches_of(matcher, one, same).empty());
}

TEST(SurfMatch, OppositeLaplaciansNeverMatch) {
  std::mt19937 rng(4);
  const SurfDescriptor d = random_descriptor(rng);
  Set a;
  Set b;
  a.add(0, 0, d, 1);
  b.add(0, 0, d, -1);
  SurfMatcher matcher({});
  EXPECT_TRUE(matches_of(matcher, a, b).empty());
  b.points[0].laplacian = 1;
  EXPECT_EQ(matches_of(matcher, a, b).size(), 1U);
}

TEST(SurfMatch, PartnersLieWithinADiscAndAFarTwinIsNoRival) {
  std::mt19937 rng(6);
  const SurfDescriptor d = random_descriptor(rng);
  Set a;
  Set b;
  a.add(100, 100, d);
  b.add(106, 108, near(d, 0.01F, rng));
  b.add(200, 100, near(d, 0.01F, rng));
  SurfMatcher matcher({});
  EXPECT_EQ(matches_of(matcher, a, b, 10.5F).size(), 1U);
  EXPECT_EQ(matches_of(matcher, a, b, 9.5F).size(), 0U);
  EXPECT_EQ(matches_of(matcher, a, b).size(), 0U);  // in a larger one the twin is a rival
}

TEST(SurfMatch, EmptySetsGiveNoMatches) {
  SurfMatcher matcher({});
  EXPECT_TRUE(matches_of(matcher, {}, {}).empty());
}

}  // namespace
}  // namespace pelorus
