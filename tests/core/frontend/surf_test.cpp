#include "core/frontend/surf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/frontend/surf_match.h"
#include "tests/core/frontend/analytic_texture.h"

namespace pelorus {
namespace {

using test::AnalyticTexture;
using test::TexturePlace;

constexpr int kWidth = 320;
constexpr int kHeight = 240;

struct Features {
  std::vector<SurfPoint> points;
  std::vector<SurfDescriptor> descriptors;
};

SurfConfig config_for(bool upright) {
  SurfConfig config;
  config.upright = upright;
  config.threshold = 2.0F;
  config.max_points = 1000;
  return config;
}

Features features_of(const Image& image, const SurfConfig& config) {
  Surf surf(config, image.width(), image.height());
  const auto points = surf.detect(image.view());
  Features f{{points.begin(), points.end()}, std::vector<SurfDescriptor>(points.size())};
  surf.describe(points, f.descriptors);
  return f;
}

TexturePlace unmoved(double u, double v) { return {u, v}; }

// A similarity about the image's centre: where a pixel of the first image appears in the second.
struct Similarity {
  double angle_rad = 0;
  double zoom = 1;
  double du = 0;
  double dv = 0;

  [[nodiscard]] TexturePlace forward(double u, double v) const {
    const double x = u - kWidth / 2.0;
    const double y = v - kHeight / 2.0;
    const double c = zoom * std::cos(angle_rad);
    const double s = zoom * std::sin(angle_rad);
    return {c * x - s * y + kWidth / 2.0 + du, s * x + c * y + kHeight / 2.0 + dv};
  }
  [[nodiscard]] TexturePlace backward(double u, double v) const {
    const double x = u - kWidth / 2.0 - du;
    const double y = v - kHeight / 2.0 - dv;
    const double c = std::cos(angle_rad) / zoom;
    const double s = std::sin(angle_rad) / zoom;
    return {c * x + s * y + kWidth / 2.0, -s * x + c * y + kHeight / 2.0};
  }
};

struct Agreement {
  double found_again = 0;    // share of points, visible in both, that have a point at their place and scale
  double right_matches = 0;  // share of the matches
  int matches = 0;
  double angle_error_rad = 0;  // mean, of right matches
};

Agreement compare(const Similarity& warp, bool upright) {
  const AnalyticTexture texture(5, 6.0);
  const Features a = features_of(test::render(texture, kWidth, kHeight, 1.0, 1, unmoved), config_for(upright));
  const Features b = features_of(
      test::render(texture, kWidth, kHeight, 1.0, 2, [&](double u, double v) { return warp.backward(u, v); }),
      config_for(upright));
  const auto agrees = [&](const SurfPoint& p, const SurfPoint& q) {
    const TexturePlace t = warp.forward(static_cast<double>(p.u_px), static_cast<double>(p.v_px));
    const double distance = std::hypot(t.u - static_cast<double>(q.u_px), t.v - static_cast<double>(q.v_px));
    return distance < 1.5 && std::abs(std::log2(warp.zoom * static_cast<double>(p.scale / q.scale))) < 0.4;
  };
  Agreement result;
  int visible = 0;
  int found = 0;
  for (const SurfPoint& p : a.points) {
    const TexturePlace t = warp.forward(static_cast<double>(p.u_px), static_cast<double>(p.v_px));
    if (t.u < 40 || t.v < 40 || t.u > kWidth - 40 || t.v > kHeight - 40) continue;
    if (warp.zoom * static_cast<double>(p.scale) < 2.2) continue;  // smaller than the least filter sees
    ++visible;
    found += std::any_of(b.points.begin(), b.points.end(), [&](const SurfPoint& q) { return agrees(p, q); });
  }
  SurfMatcher matcher({});
  int right = 0;
  for (const SurfMatch& m : matcher.match(a.points, a.descriptors, b.points, b.descriptors, kAnywhere_px)) {
    const SurfPoint& p = a.points[static_cast<std::size_t>(m.first)];
    const SurfPoint& q = b.points[static_cast<std::size_t>(m.second)];
    ++result.matches;
    if (!agrees(p, q)) continue;
    ++right;
    const double turned = static_cast<double>(q.angle_rad - p.angle_rad) - warp.angle_rad;
    result.angle_error_rad += std::abs(std::remainder(turned, 2 * std::numbers::pi));
  }
  result.found_again = found / static_cast<double>(std::max(1, visible));
  result.right_matches = right / static_cast<double>(std::max(1, result.matches));
  result.angle_error_rad /= std::max(1, right);
  return result;
}

TEST(Surf, PointsAndMatchesSurviveASubPixelShift) {
  const Agreement a = compare({0, 1, 7.3, -4.6}, true);
  EXPECT_GT(a.found_again, 0.8);
  EXPECT_GT(a.matches, 60);
  EXPECT_GT(a.right_matches, 0.97);
}

TEST(Surf, OrientedPointsAndMatchesSurviveRotation) {
  for (const double angle_deg : {20.0, 45.0, 90.0, 160.0}) {
    const Agreement a = compare({angle_deg * std::numbers::pi / 180, 1, 0.4, 0.2}, false);
    EXPECT_GT(a.found_again, 0.6) << angle_deg;
    EXPECT_GT(a.matches, 30) << angle_deg;
    EXPECT_GT(a.right_matches, 0.85) << angle_deg;
    EXPECT_LT(a.angle_error_rad, 0.1) << angle_deg;
  }
}

TEST(Surf, UprightMatchesDoNotSurviveAQuarterTurn) {  // or the test above would prove nothing
  EXPECT_LT(compare({std::numbers::pi / 2, 1, 0, 0}, true).right_matches, 0.5);
}

TEST(Surf, PointsAndMatchesSurviveZoom) {
  for (const double zoom : {0.8, 1.25, 1.6}) {
    const Agreement a = compare({0, zoom, 0, 0}, true);
    EXPECT_GT(a.found_again, 0.6) << zoom;
    EXPECT_GT(a.matches, 20) << zoom;
    EXPECT_GT(a.right_matches, 0.9) << zoom;
  }
}

TEST(Surf, ABlobIsFoundAtItsPlaceAndScale) {
  for (const double sigma : {2.5, 4.0, 6.5}) {
    Image image(160, 140);
    for (int v = 0; v < 140; ++v) {
      for (int u = 0; u < 160; ++u) {
        const double r2 = std::pow(u - 80.3, 2) + std::pow(v - 69.6, 2);
        image.row(v)[u] = static_cast<std::uint8_t>(std::lround(50 + 150 * std::exp(-r2 / (2 * sigma * sigma))));
      }
    }
    Surf surf(config_for(true), 160, 140);
    const auto points = surf.detect(image.view());
    ASSERT_FALSE(points.empty()) << sigma;
    EXPECT_NEAR(static_cast<double>(points[0].u_px), 80.3, 0.25);
    EXPECT_NEAR(static_cast<double>(points[0].v_px), 69.6, 0.25);
    // Exact Gaussian derivatives would peak at the blob's own sigma; boxes are wider and do at three quarters of it.
    EXPECT_NEAR(static_cast<double>(points[0].scale), 0.75 * sigma, 0.1 * sigma);
    EXPECT_EQ(points[0].laplacian, -1);
  }
}

TEST(Surf, DescriptorsDoNotFeelOffsetAndGainOfTheLight) {
  const AnalyticTexture texture(5, 6.0, 0.7);
  const Image plain = test::render(texture, kWidth, kHeight, 0.0, 1, unmoved);
  const Image lit =
      test::render(texture, kWidth, kHeight, 0.0, 1, unmoved, [](double grey, int, int) { return 0.6 * grey + 70; });
  for (const bool upright : {true, false}) {
    Surf a(config_for(upright), kWidth, kHeight);
    Surf b(config_for(upright), kWidth, kHeight);
    const auto found = a.detect(plain.view());
    const std::vector<SurfPoint> points(found.begin(), found.end());
    std::vector<SurfDescriptor> of_a(points.size());
    std::vector<SurfDescriptor> of_b(points.size());
    a.describe(points, of_a);
    (void)b.detect(lit.view());
    b.describe(points, of_b);
    ASSERT_GT(points.size(), 50U);
    for (std::size_t i = 0; i < points.size(); ++i) {
      float square = 0;
      float length = 0;
      for (std::size_t k = 0; k < 64; ++k) {
        square += (of_a[i][k] - of_b[i][k]) * (of_a[i][k] - of_b[i][k]);
        length += of_a[i][k] * of_a[i][k];
      }
      EXPECT_LT(std::sqrt(square), 0.05F) << i;
      EXPECT_NEAR(length, 1.0F, 1e-4F);
    }
  }
}

TEST(Surf, TheStrongestComeFirstAndTheCountIsBounded) {
  const Image image = test::render(AnalyticTexture(5, 6.0), kWidth, kHeight, 1.0, 1, unmoved);
  SurfConfig config = config_for(true);
  config.max_points = 5000;
  const std::vector<SurfPoint> all = features_of(image, config).points;
  config.max_points = 37;
  const std::vector<SurfPoint> few = features_of(image, config).points;
  ASSERT_GT(all.size(), 100U);
  ASSERT_EQ(few.size(), 37U);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].u_px, all[i].u_px);
    EXPECT_EQ(few[i].v_px, all[i].v_px);
    EXPECT_GE(few[i > 0 ? i - 1 : 0].response, few[i].response);
  }
}

// What turbid water does to a picture: all contrasts shrink alike.
TEST(Surf, WhereContrastIsLowTheThresholdFallsWithIt) {
  const AnalyticTexture texture(5, 6.0);
  const auto seen_through = [&](double contrast) {
    return test::render(texture, kWidth, kHeight, 0.0, 1, unmoved,
                        [=](double grey, int, int) { return 128 + contrast * (grey - 128); });
  };
  SurfConfig config = config_for(true);
  config.max_points = 5000;
  config.threshold = 10.0F;
  config.faint_threshold = 10.0F;
  const auto clear = features_of(seen_through(1.0), config).points;
  const auto dim_fixed = features_of(seen_through(0.25), config).points;
  config.faint_threshold = 1.0F;
  const auto clear_falling = features_of(seen_through(1.0), config).points;
  const auto dim_falling = features_of(seen_through(0.25), config).points;
  ASSERT_GT(clear.size(), 100U);
  EXPECT_LT(dim_fixed.size(), clear.size() / 2);
  EXPECT_GT(dim_falling.size(), clear.size() * 3 / 4);
  EXPECT_LE(clear_falling.size(), clear.size() * 102 / 100);
  EXPECT_GE(clear_falling.size(), clear.size());
  for (const SurfPoint& p : clear_falling) EXPECT_GE(p.response, 10.0F);
  for (const SurfPoint& p : dim_falling) EXPECT_GE(p.response, 1.0F);
}

int twins_in(const std::vector<SurfPoint>& points) {
  int twins = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const float smaller = std::min(points[i].scale, points[k].scale);
      const float larger = std::max(points[i].scale, points[k].scale);
      const float apart_px = std::hypot(points[i].u_px - points[k].u_px, points[i].v_px - points[k].v_px);
      if (apart_px < smaller && larger < 1.2F * smaller) ++twins;
    }
  }
  return twins;
}

TEST(Surf, OneBlobIsOnePointThoughTwoOctavesSeeIt) {
  const Image image = test::render(AnalyticTexture(5, 6.0), kWidth, kHeight, 1.0, 1, unmoved);
  SurfConfig config = config_for(true);
  for (const int intervals : {4, 5}) {
    config.intervals = intervals;
    config.distinct = true;
    const auto distinct = features_of(image, config).points;
    config.distinct = false;
    const auto all = features_of(image, config).points;
    EXPECT_EQ(twins_in(distinct), 0);
    EXPECT_GT(twins_in(all), 0);  // or there was nothing to drop
    EXPECT_GT(distinct.size(), all.size() / 2);
  }
}

TEST(Surf, AFlatOrTinyImageHasNoPoints) {
  Surf surf(config_for(true), 64, 48);
  EXPECT_TRUE(surf.detect(Image(64, 48).view()).empty());
  Surf tiny(config_for(true), 7, 5);
  EXPECT_TRUE(tiny.detect(Image(7, 5).view()).empty());
}

TEST(Surf, PointsAtTheEdgeAndOutsideGetFiniteDescriptors) {
  const Image image = test::render(AnalyticTexture(5, 6.0), 80, 60, 1.0, 1, unmoved);
  for (const bool upright : {true, false}) {
    Surf surf(config_for(upright), 80, 60);
    (void)surf.detect(image.view());
    std::vector<SurfPoint> points;
    for (const float u : {-50.0F, 0.0F, 79.0F, 200.0F}) {
      for (const float v : {0.0F, 59.0F}) points.push_back({u, v, 3.0F, 0.7F, 1.0F, 1});
    }
    std::vector<SurfDescriptor> descriptors(points.size());
    surf.describe(points, descriptors);
    for (const SurfDescriptor& d : descriptors) {
      for (const float x : d) EXPECT_TRUE(std::isfinite(x));
    }
  }
}

}  // namespace
}  // namespace pelorus
