// Clean renders must be good enough to tune sub-pixel tracking on: OpenCV's corners and KLT, an implementation that
// shares no code with ours, against the truth.

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"
#include "tests/drivers/synthetic/small_dive.h"

namespace pelorus::synthetic {
namespace {

cv::Mat copy_of(const Image& image) {
  cv::Mat grey(image.height(), image.width(), CV_8U);
  for (int v = 0; v < image.height(); ++v) std::copy_n(image.row(v), image.width(), grey.ptr(v));
  return grey;
}

bool near_edge(const Film& film, int u, int v) {
  constexpr int kReach = 9;  // KLT window and pyramid
  for (int dv = -kReach; dv <= kReach; dv += 3)
    for (int du = -kReach; du <= kReach; du += 3) {
      const std::size_t there = film.at(std::clamp(u + du, 0, film.width - 1), std::clamp(v + dv, 0, film.height - 1));
      if (solid_of_key(film.keys[there]) != solid_of_key(film.keys[film.at(u, v)])) return true;
    }
  return false;
}

TEST(Tracking, KltFollowsTheCleanSceneWithinATwentiethOfAPixel) {
  const Result<Scene> scene = load_scene(PELORUS_SOURCE_DIR "/config/scenes/paper.yaml");
  ASSERT_TRUE(scene.ok()) << scene.error().message();
  SyntheticSource source(scene.value());
  SourcePair prev;
  SourcePair curr;
  source.render(31, curr);
  source.render(30, prev);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(copy_of(prev.left), corners, 2000, 0.01, 8);
  EXPECT_GE(corners.size(), 1500U);
  std::vector<cv::Point2f> tracked;
  std::vector<std::uint8_t> found;
  std::vector<float> ignored;
  const cv::TermCriteria precise(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3);
  cv::calcOpticalFlowPyrLK(copy_of(prev.left), copy_of(curr.left), corners, tracked, found, ignored, {15, 15}, 3,
                           precise);
  const Rigid3 T_curr_prev = source.T_world_cam(31).inverse() * source.T_world_cam(30);
  const int bodies = static_cast<int>(source.scene().bodies.size());
  std::vector<double> errors_static;
  std::vector<double> errors_object;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int u = static_cast<int>(corners[i].x);
    const int v = static_cast<int>(corners[i].y);
    const Film& film = source.left_film();
    const int solid = solid_of_key(film.keys[film.at(u, v)]);
    if (found[i] == 0 || near_edge(film, u, v)) continue;
    const bool moves = solid >= 0 && solid < bodies;
    Rigid3 H_curr_prev = T_curr_prev;
    if (moves) {
      const Rigid3 M_world = source.T_world_obj(solid, 31) * source.T_world_obj(solid, 30).inverse();
      H_curr_prev = source.T_world_cam(31).inverse() * M_world * source.T_world_cam(30);
    }
    const Eigen::Vector2d uv = project(source.scene().camera, H_curr_prev * p_cam_at(source, u, v));
    if (uv.x() < 12 || uv.y() < 12 || uv.x() > film.width - 12 || uv.y() > film.height - 12) continue;
    const double error_px =
        std::hypot(static_cast<double>(tracked[i].x) - uv.x(), static_cast<double>(tracked[i].y) - uv.y());
    (moves ? errors_object : errors_static).push_back(error_px);
  }
  const auto median = [](std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
  };
  ASSERT_GT(errors_static.size(), 1000U);
  ASSERT_GT(errors_object.size(), 100U);
  EXPECT_LT(median(errors_static), 0.05);
  EXPECT_LT(median(errors_object), 0.08);
}

}  // namespace
}  // namespace pelorus::synthetic
