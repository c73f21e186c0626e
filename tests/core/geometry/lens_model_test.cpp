#include "core/geometry/lens_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <random>
#include <vector>

namespace pelorus {
namespace {

CameraIntrinsics camera(LensKind lens, std::array<double, 8> k) {
  // Rational and 5-coefficient lenses below were calibrated for narrower views than EuRoC's.
  const double f_px = lens == LensKind::equidistant || lens == LensKind::none || k[4] == 0 ? 458.6 : 900.0;
  return {752, 480, f_px, f_px - 1.3, 367.2, 248.4, lens, k};
}

const CameraIntrinsics kEuroc = camera(LensKind::radtan, {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05});
const CameraIntrinsics kRadtan5 = camera(LensKind::radtan, {-0.3729, 0.2037, 0.002219, 0.0013837, -0.07233});
const CameraIntrinsics kRational = camera(LensKind::rational, {0.4, -0.08, 0.0004, -0.0003, 0.01, 0.75, 0.05, 0.02});
const CameraIntrinsics kFisheye = camera(LensKind::equidistant, {-0.013, 0.02, -0.012, 0.0023});
const CameraIntrinsics kPinhole = camera(LensKind::none, {});

class EveryLens : public testing::TestWithParam<CameraIntrinsics> {};

TEST_P(EveryLens, UnprojectInvertsProjectOverTheWholeImage) {
  const LensModel lens(GetParam());
  int seen = 0;
  for (int v = 0; v < 480; v += 20) {
    for (int u = 0; u < 752; u += 20) {
      const Eigen::Vector2d raw_px(u, v);
      Eigen::Vector3d v_raw;
      Eigen::Vector2d back_px;
      ASSERT_TRUE(lens.unproject(raw_px, v_raw)) << u << " " << v;
      EXPECT_NEAR(v_raw.norm(), 1.0, 1e-12);
      ASSERT_TRUE(lens.project(v_raw * 3.7, back_px));
      EXPECT_LT((back_px - raw_px).norm(), 1e-6) << u << " " << v;
      ++seen;
    }
  }
  EXPECT_GT(seen, 800);
}

TEST_P(EveryLens, ProjectsAsOpenCvDoes) {
  const CameraIntrinsics& c = GetParam();
  const LensModel lens(c);
  const cv::Matx33d K(c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1);
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> offset(-0.7, 0.7);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(2 * offset(rng), 2 * offset(rng), 2.0);
  std::vector<cv::Point2d> oracle;
  const std::size_t count = c.lens == LensKind::equidistant ? 4 : 8;
  const std::vector<double> k(c.distortion.begin(), c.distortion.begin() + static_cast<std::ptrdiff_t>(count));
  if (c.lens == LensKind::equidistant) {
    cv::fisheye::projectPoints(points, oracle, cv::Vec3d(), cv::Vec3d(), K, k);
  } else {
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K, k, oracle);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector2d raw_px;
    ASSERT_TRUE(lens.project({points[i].x, points[i].y, points[i].z}, raw_px));
    EXPECT_NEAR(raw_px.x(), oracle[i].x, 1e-9);
    EXPECT_NEAR(raw_px.y(), oracle[i].y, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(LensModel, EveryLens, testing::Values(kEuroc, kRadtan5, kRational, kFisheye, kPinhole));

// Far outside the view the polynomial of a barrel lens turns round and would bring points back into the image.
TEST(LensModel, RefusesPointsBeyondTheFoldOfThePolynomial) {
  const LensModel lens(kRadtan5);
  Eigen::Vector2d raw_px;
  EXPECT_TRUE(lens.project({0.8, 0.5, 1.0}, raw_px));
  EXPECT_FALSE(lens.project({9.0, 0.0, 1.0}, raw_px));
  EXPECT_FALSE(lens.project({0.1, 0.1, -1.0}, raw_px));
}

TEST(LensModel, FisheyeSeesBeyondTheImagePlane) {
  CameraIntrinsics wide = kFisheye;
  wide.fx_px = wide.fy_px = 180;
  const LensModel lens(wide);
  const double angle_rad = 100.0 * std::numbers::pi / 180.0;
  const Eigen::Vector3d v_raw(std::sin(angle_rad), 0, std::cos(angle_rad));
  Eigen::Vector2d raw_px;
  Eigen::Vector3d back;
  ASSERT_TRUE(lens.project(v_raw, raw_px));
  ASSERT_TRUE(lens.unproject(raw_px, back));
  EXPECT_LT((back - v_raw).norm(), 1e-9);
}

}  // namespace
}  // namespace pelorus
