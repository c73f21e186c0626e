#include "services/overlay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "services/body_colors.h"

namespace pelorus {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr BodyId kBody{3};
constexpr BodyId kOtherBody{4};

class OverlayTest : public ::testing::Test {
 protected:
  OverlayTest() {
    for (int v = 0; v < kHeight; ++v) std::fill_n(left_.row(v), kWidth, std::uint8_t{100});
    result_.state = VisionState::tracking;
    result_.objects_size = 1;
    ObjectState& object = result_.objects[0];
    object.id = kBody;
    object.phase = ObjectPhase::confirmed;
    object.centroid_world = Eigen::Vector3d(0.16, 0.3, 1);  // at (200, 195)
  }
  void add_point(double u_px, double v_px, BodyId body) {
    PointView point;
    point.curr.z_px = {u_px, v_px, u_px - 10};
    point.body = body;
    points_.push_back(point);
  }
  // A pixel of the left picture, which is below the banner.
  [[nodiscard]] Rgb pixel(int u, int v) const {
    const cv::Mat drawn = overlay_.draw(left_.view(), result_, points_);
    return rgb(drawn.at<cv::Vec3b>(v + drawn.rows - kHeight, u));
  }
  [[nodiscard]] Rgb banner_pixel(int u, int v) const {
    return rgb(overlay_.draw(left_.view(), result_, points_).at<cv::Vec3b>(v, u));
  }
  static Rgb rgb(const cv::Vec3b& bgr) { return {bgr[2], bgr[1], bgr[0]}; }
  static bool same(Rgb a, Rgb b) {
    const auto near = [](int x, int y) { return std::abs(x - y) <= 3; };  // edges are smoothed
    return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue);
  }

  Image left_{kWidth, kHeight};
  Overlay overlay_{StereoRig{kWidth, kHeight, 250, 160, 120, 0.12}};
  FrameResult result_;
  std::vector<PointView> points_;
};

TEST_F(OverlayTest, PointsHaveTheColorOfWhatTheyBelongTo) {
  add_point(60, 60, kWorldBody);
  add_point(120, 60, kBody);
  add_point(180, 60, kNoBody);
  EXPECT_TRUE(same(pixel(60, 60), kStaticColor));
  EXPECT_TRUE(same(pixel(120, 60), object_color(kBody)));
  EXPECT_TRUE(same(pixel(180, 60), Rgb{255, 255, 255}));
  EXPECT_TRUE(same(pixel(90, 60), Rgb{85, 85, 85})) << "the picture, a little darker";
}

TEST_F(OverlayTest, PointsOfABodyThatIsNotPublishedAreDarkerInItsColor) {
  add_point(120, 60, kOtherBody);
  const Rgb color = object_color(kOtherBody);
  const auto darker = [](std::uint8_t value) { return static_cast<std::uint8_t>(0.7 * value); };
  EXPECT_TRUE(same(pixel(120, 60), Rgb{darker(color.red), darker(color.green), darker(color.blue)}));
}

TEST_F(OverlayTest, AnObjectHasItsOutlineAndItsLabel) {
  ObjectState& object = result_.objects[0];
  object.outline[0] = {30, 120};
  object.outline[1] = {90, 120};
  object.outline[2] = {90, 180};
  object.outline[3] = {30, 180};
  object.outline_size = 4;
  EXPECT_TRUE(same(pixel(60, 120), object_color(kBody)));
  EXPECT_TRUE(same(pixel(90, 150), object_color(kBody)));
  EXPECT_TRUE(same(pixel(60, 150), Rgb{85, 85, 85})) << "its inside stays as it is";
  EXPECT_TRUE(same(pixel(31, 110), object_color(kBody))) << "the mark of the label above it";
  object.phase = ObjectPhase::ended;
  EXPECT_TRUE(same(pixel(60, 120), Rgb{85, 85, 85}));
}

TEST_F(OverlayTest, TheBannerTellsTheStateByItsColor) {
  for (const VisionState state : {VisionState::tracking, VisionState::degraded, VisionState::lost}) {
    result_.state = state;
    EXPECT_TRUE(same(banner_pixel(2, 2), state_color(state)));
  }
}

}  // namespace
}  // namespace pelorus
