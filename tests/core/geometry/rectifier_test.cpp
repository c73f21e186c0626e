#include "core/geometry/rectifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

namespace pelorus {
namespace {

// EuRoC's own figures: two lenses of 65 deg, 1.4 deg apart in direction, 0.11 m apart in place.
StereoCalibration euroc() {
  StereoCalibration c;
  c.left = {752,     480,     458.654,          457.296,
            367.215, 248.375, LensKind::radtan, {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}};
  c.right = {752,     480,     457.587,          456.134,
             379.999, 255.238, LensKind::radtan, {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05}};
  c.T_right_left.linear() = so3_exp({0.0071, -0.0141, 0.0023});
  c.T_right_left.translation() = Eigen::Vector3d(-0.11007, 0.00040, -0.00085);
  c.T_body_left = se3_exp((Vector6d() << -0.02, -0.06, 0.01, 0.1, -0.2, 1.5).finished());
  return c;
}

StereoCalibration fisheye() {
  StereoCalibration c = euroc();
  c.left.lens = c.right.lens = LensKind::equidistant;
  c.left.distortion = {-0.013, 0.02, -0.012, 0.0023};
  c.right.distortion = {-0.011, 0.018, -0.013, 0.0021};
  c.left.fx_px = c.left.fy_px = c.right.fx_px = c.right.fy_px = 285;
  return c;
}

StereoCalibration rectified() {
  StereoCalibration c;
  c.left = c.right = {1241, 376, 718.856, 718.856, 607.1928, 185.2157, LensKind::none, {}};
  c.T_right_left.translation() = Eigen::Vector3d(-0.537, 0, 0);
  c.rectified = true;
  return c;
}

Rectifier make(const StereoCalibration& c, const RectifierConfig& config = {}) {
  auto made = Rectifier::create(c, "test", config);
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message());
  return made.value();
}

Image noise_image(int width, int height) {
  std::mt19937 rng(4);
  Image image(width, height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) image.row(v)[u] = static_cast<std::uint8_t>(rng());
  return image;
}

cv::Mat to_cv(const Eigen::MatrixXd& m) {
  cv::Mat out(static_cast<int>(m.rows()), static_cast<int>(m.cols()), CV_64F);
  for (int i = 0; i < out.rows; ++i)
    for (int k = 0; k < out.cols; ++k) out.at<double>(i, k) = m(i, k);
  return out;
}

cv::Mat camera_matrix(const CameraIntrinsics& c) {
  return (cv::Mat_<double>(3, 3) << c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1);
}

cv::Mat rectified_matrix(const StereoRig& rig) {
  return (cv::Mat_<double>(3, 3) << rig.f_px, 0, rig.cx_px, 0, rig.f_px, rig.cy_px, 0, 0, 1);
}

// The whole chain: a point in the scene, its two raw pixels, back through the lens and onto the rectified planes.
void expect_rows_match(const StereoCalibration& c) {
  const Rectifier rectifier = make(c);
  const StereoRig& rig = rectifier.rig();
  const LensModel left(c.left);
  const LensModel right(c.right);
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> across(-0.6, 0.6);
  std::uniform_real_distribution<double> depth_m(0.8, 9.0);
  for (int i = 0; i < 300; ++i) {
    const double z_m = depth_m(rng);
    const Eigen::Vector3d p_left(across(rng) * z_m, 0.6 * across(rng) * z_m, z_m);
    Eigen::Vector2d left_px;
    Eigen::Vector2d right_px;
    if (!left.project(p_left, left_px) || !right.project(c.T_right_left * p_left, right_px)) continue;
    Eigen::Vector3d v_left;
    Eigen::Vector3d v_right;
    ASSERT_TRUE(left.unproject(left_px, v_left) && right.unproject(right_px, v_right));
    v_left = rectifier.R_cam_left() * v_left;
    v_right = rectifier.R_cam_r_right() * v_right;
    const double row_left = rig.f_px * v_left.y() / v_left.z() + rig.cy_px;
    const double row_right = rig.f_px * v_right.y() / v_right.z() + rig.cy_px;
    EXPECT_NEAR(row_left, row_right, 0.01);
    const Eigen::Vector3d z_px(rig.f_px * v_left.x() / v_left.z() + rig.cx_px, row_left,
                               rig.f_px * v_right.x() / v_right.z() + rig.cx_px);
    EXPECT_LT((rig.triangulate(z_px) - rectifier.R_cam_left() * p_left).norm(), 1e-6);
  }
}

TEST(Rectifier, BringsBothImagesOfAPointIntoOneRowAndGivesItsPlace) { expect_rows_match(euroc()); }
TEST(Rectifier, DoesSoForFisheyeLenses) { expect_rows_match(fisheye()); }

TEST(Rectifier, TurnsTheCamerasAsOpenCvDoes) {
  const StereoCalibration c = euroc();
  const Rectifier rectifier = make(c);
  cv::Mat R1, R2, P1, P2, Q;
  cv::stereoRectify(camera_matrix(c.left), cv::Mat(), camera_matrix(c.right), cv::Mat(), {752, 480},
                    to_cv(c.T_right_left.linear()), to_cv(c.T_right_left.translation()), R1, R2, P1, P2, Q);
  EXPECT_LT(cv::norm(R1, to_cv(rectifier.R_cam_left())), 1e-9);
  EXPECT_LT(cv::norm(R2, to_cv(rectifier.R_cam_r_right())), 1e-9);
  EXPECT_NEAR(rectifier.rig().baseline_m, c.T_right_left.translation().norm(), 1e-12);
}

TEST(Rectifier, TablesAgreeWithOpenCvMaps) {
  const StereoCalibration c = euroc();
  const Rectifier rectifier = make(c);
  cv::Mat map_u, map_v;
  const std::vector<double> k(c.right.distortion.begin(), c.right.distortion.begin() + 4);
  cv::initUndistortRectifyMap(camera_matrix(c.right), k, to_cv(rectifier.R_cam_r_right()),
                              rectified_matrix(rectifier.rig()), {752, 480}, CV_32FC1, map_u, map_v);
  const RemapTable& table = rectifier.right_table();
  for (int v = 0; v < 480; v += 7) {
    for (int u = 0; u < 752; u += 7) {
      // Half a step of the fixed-point table and the rounding to the image's edge.
      EXPECT_NEAR(table.raw_px(u, v).x(), static_cast<double>(map_u.at<float>(v, u)), 0.005);
      EXPECT_NEAR(table.raw_px(u, v).y(), static_cast<double>(map_v.at<float>(v, u)), 0.005);
    }
  }
}

TEST(Rectifier, WarpsAnImageAsOpenCvDoes) {
  const StereoCalibration c = euroc();
  const Rectifier rectifier = make(c);
  Image raw(752, 480);
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 752; ++u)
      raw.row(v)[u] = static_cast<std::uint8_t>(std::lround(127 + 60 * std::sin(u * 0.21) + 60 * std::cos(v * 0.17)));
  cv::Mat map_u, map_v, oracle;
  const std::vector<double> k(c.left.distortion.begin(), c.left.distortion.begin() + 4);
  cv::initUndistortRectifyMap(camera_matrix(c.left), k, to_cv(rectifier.R_cam_left()),
                              rectified_matrix(rectifier.rig()), {752, 480}, CV_32FC1, map_u, map_v);
  const cv::Mat raw_cv(480, 752, CV_8U, raw.row(0), static_cast<std::size_t>(raw.stride()));
  cv::remap(raw_cv, oracle, map_u, map_v, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  Image out;
  rectifier.apply_left(raw.view(), out);
  int worst = 0;
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 752; ++u)
      worst =
          std::max(worst, std::abs(static_cast<int>(out.row(v)[u]) - static_cast<int>(oracle.at<std::uint8_t>(v, u))));
  EXPECT_LE(worst, 1);  // OpenCV's weights have 5 bits, ours 7
}

// A pixel by definition, from the table's own positions (multiples of 1/128 px).
int mixed(const RemapTable& table, const Image& raw, int u, int v) {
  if (!table.covered(u, v)) return 0;
  const Eigen::Vector2d p = table.raw_px(u, v);
  const int x = std::min(static_cast<int>(p.x()), raw.width() - 2);
  const int y = std::min(static_cast<int>(p.y()), raw.height() - 2);
  const int a = static_cast<int>(std::lround((p.x() - x) * 128));
  const int b = static_cast<int>(std::lround((p.y() - y) * 128));
  const std::uint8_t* upper = raw.row(y) + x;
  const std::uint8_t* lower = raw.row(y + 1) + x;
  const int top = upper[0] * (128 - a) + upper[1] * a;
  const int bottom = lower[0] * (128 - a) + lower[1] * a;
  return (top * (128 - b) + bottom * b + 8192) >> 14;
}

int wrong_pixels(const RemapTable& table, const Image& raw) {
  Image out;
  table.apply(raw.view(), out);
  int wrong = 0;
  for (int v = 0; v < table.height(); ++v)
    for (int u = 0; u < table.width(); ++u) wrong += out.row(v)[u] != mixed(table, raw, u, v);
  return wrong;
}

TEST(Rectifier, BlocksAndSinglePixelsMixTheSameWay) {
  const Image raw = noise_image(752, 480);
  for (const double alpha : {0.0, 1.0}) {
    for (const StereoCalibration& c : {euroc(), fisheye()}) {
      const Rectifier rectifier = make(c, {.alpha = alpha});
      EXPECT_EQ(wrong_pixels(rectifier.left_table(), raw), 0);
      EXPECT_EQ(wrong_pixels(rectifier.right_table(), raw), 0);
    }
  }
  // All of EuRoC's pixels come in blocks.
  EXPECT_GT(make(euroc()).left_table().blocks(), 752U * 480U / 8U * 99U / 100U);
}

TEST(Rectifier, TurnsTooSteepForBlocksAndNarrowTablesWorkToo) {
  const Image raw = noise_image(100, 80);
  for (const int width : {3, 8, 13, 60}) {
    for (const double slope : {0.0, 0.1, 1.0}) {
      RemapTable table(width, 20, 100, 80);
      for (int v = 0; v < 20; ++v)
        for (int u = 0; u < width; ++u) table.set(u, v, {1.3 * u + 0.4 * v - 2, 0.9 * v + slope * u + 70 - 50 * slope});
      EXPECT_EQ(wrong_pixels(table, raw), 0) << "before finish()";
      table.finish();
      EXPECT_EQ(wrong_pixels(table, raw), 0);
    }
  }
}

TEST(Rectifier, FillsTheImageWithoutBlackBorders) {
  for (const StereoCalibration& c : {euroc(), fisheye()}) {
    const Rectifier rectifier = make(c);
    int black = 0;
    for (int v = 0; v < 480; ++v)
      for (int u = 0; u < 752; ++u)
        black += !rectifier.left_table().covered(u, v) + !rectifier.right_table().covered(u, v);
    EXPECT_EQ(black, 0);
  }
}

// Not more zoom than needed: one pixel further out and a border would show.
TEST(Rectifier, KeepsAsMuchViewAsThereIs) {
  const Rectifier filled = make(euroc());
  const Rectifier everything = make(euroc(), {.alpha = 1.0});
  EXPECT_LT(filled.rig().f_px, 458);
  EXPECT_GT(filled.rig().f_px, 400);
  EXPECT_LT(everything.rig().f_px, filled.rig().f_px);
  EXPECT_FALSE(everything.left_table().covered(0, 0));
}

TEST(Rectifier, PassesARectifiedPairThroughUnchanged) {
  const Rectifier rectifier = make(rectified());
  EXPECT_TRUE(rectifier.is_pass_through());
  EXPECT_EQ(rectifier.rig().f_px, 718.856);
  EXPECT_EQ(rectifier.rig().cx_px, 607.1928);
  EXPECT_EQ(rectifier.rig().cy_px, 185.2157);
  EXPECT_EQ(rectifier.rig().baseline_m, 0.537);
  Image raw(1241, 376);
  raw.row(17)[23] = 99;
  Image out;
  rectifier.apply_right(raw.view(), out);
  EXPECT_EQ(out.row(17)[23], 99);
}

// Cameras that share rows but not the principal point still need a shift: disparity would be biased.
TEST(Rectifier, DoesNotPassUnequalIntrinsicsThrough) {
  StereoCalibration c = rectified();
  c.right.cx_px += 5;
  EXPECT_FALSE(make(c).is_pass_through());
}

TEST(Rectifier, KeepsTheCameraCenterOnTheBody) {
  const StereoCalibration c = euroc();
  const Rectifier rectifier = make(c);
  const Eigen::Vector3d p_left(0.3, -0.1, 2.0);
  const Eigen::Vector3d p_cam = rectifier.R_cam_left() * p_left;
  EXPECT_LT((rectifier.T_body_cam() * p_cam - c.T_body_left * p_left).norm(), 1e-12);
}

TEST(Rectifier, RefusesCamerasWithoutBaselineSwappedOrStacked) {
  StereoCalibration c = rectified();
  c.T_right_left.translation().setZero();
  EXPECT_NE(Rectifier::create(c, "f.yaml:3").error().message().find("no baseline"), std::string::npos);
  c.T_right_left.translation() = Eigen::Vector3d(0.5, 0, 0);
  const Error swapped = Rectifier::create(c, "f.yaml:3").error();
  EXPECT_NE(swapped.message().find("negative baseline"), std::string::npos);
  EXPECT_EQ(swapped.place, "f.yaml:3");
  EXPECT_EQ(swapped.code, ErrorCode::bad_calibration);
  c.T_right_left.translation() = Eigen::Vector3d(0, -0.5, 0);
  EXPECT_NE(Rectifier::create(c, "f.yaml:3").error().message().find("horizontal"), std::string::npos);
}

TEST(Rectifier, RefusesAbsurdIntrinsics) {
  StereoCalibration c = rectified();
  c.left.fx_px = 0.7;
  EXPECT_NE(Rectifier::create(c, "f").error().message().find("left camera: focal length"), std::string::npos);
  c = rectified();
  c.right.cx_px = 9000;
  EXPECT_NE(Rectifier::create(c, "f").error().message().find("right camera: principal point"), std::string::npos);
  c = rectified();
  c.right.width = 640;
  EXPECT_NE(Rectifier::create(c, "f").error().message().find("1241x376 and 640x376"), std::string::npos);
}

}  // namespace
}  // namespace pelorus
