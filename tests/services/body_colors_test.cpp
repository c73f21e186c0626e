#include "services/body_colors.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace pelorus {
namespace {

constexpr int kColors = 8;

Eigen::Vector3d linear_light(Rgb color) {
  const auto linear = [](std::uint8_t value) {
    const double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return {linear(color.red), linear(color.green), linear(color.blue)};
}

double luminance(Rgb color) { return linear_light(color).dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722)); }

double contrast(Rgb a, Rgb b) {
  const double brighter = std::max(luminance(a), luminance(b));
  return (brighter + 0.05) / (std::min(luminance(a), luminance(b)) + 0.05);
}

// Normal sight and the total lack of one kind of cones: Machado, Oliveira, Fernandes 2009, on linear light.
std::array<Eigen::Matrix3d, 4> kinds_of_sight() {
  std::array<Eigen::Matrix3d, 4> sights;
  sights[0].setIdentity();
  sights[1] << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998;
  sights[2] << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
  sights[3] << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900;
  return sights;
}

// Oklab (Ottosson 2020), where equal distances look equally different; lightness 0 to 100.
Eigen::Vector3d oklab(const Eigen::Vector3d& light) {
  Eigen::Matrix3d cones, opponents;
  cones << 0.4122214708, 0.5363325363, 0.0514459929, 0.2119034982, 0.6806995451, 0.1073969566, 0.0883024619,
      0.2817188376, 0.6299787005;
  opponents << 0.2104542553, 0.7936177850, -0.0040720468, 1.9779984951, -2.4285922050, 0.4505937099, 0.0259040371,
      0.7827717662, -0.8086757660;
  return 100 * opponents * (cones * light.cwiseMax(0).cwiseMin(1)).cwiseMax(0).array().pow(1.0 / 3).matrix();
}

// As seen with the sight that confuses them most. Below 2 nobody sees a difference; three times that is plain.
constexpr double kPlain = 6;
// The search that found these colors left 8.50 between any two bodies; a tenth is for the rounding of that figure.
constexpr double kBetweenBodies = 8.4;
double least_difference(Rgb a, Rgb b) {
  double least = 100;
  for (const Eigen::Matrix3d& sight : kinds_of_sight()) {
    least = std::min(least, (oklab(sight * linear_light(a)) - oklab(sight * linear_light(b))).norm());
  }
  return least;
}

TEST(BodyColors, AreToldApartWithAnyKindOfColorBlindness) {
  for (int a = 1; a <= kColors; ++a) {
    EXPECT_GT(least_difference(object_color(BodyId{a}), kStaticColor), kPlain) << a << " and the static scene";
    for (int b = 1; b < a; ++b) {
      EXPECT_GT(least_difference(object_color(BodyId{a}), object_color(BodyId{b})), kBetweenBodies)
          << a << " and " << b;
    }
  }
}

TEST(BodyColors, StandOutOnADarkPictureAndOnWhitePaper) {
  for (int id = 1; id <= kColors; ++id) {
    EXPECT_GE(contrast(object_color(BodyId{id}), Rgb{255, 255, 255}), 3) << id;
    EXPECT_GE(contrast(object_color(BodyId{id}), Rgb{13, 23, 32}), 3) << id;
  }
}

}  // namespace
}  // namespace pelorus
