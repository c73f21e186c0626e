#include "drivers/synthetic/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/synthetic/synthetic_source.h"
#include "tests/drivers/synthetic/small_dive.h"

namespace pelorus::synthetic {
namespace {

bool same_pixels(const Image& a, const Image& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  for (int v = 0; v < a.height(); ++v)
    if (!std::equal(a.row(v), a.row(v) + a.width(), b.row(v))) return false;
  return true;
}

bool same_pair(const SourcePair& a, const SourcePair& b) {
  return a.capture_time == b.capture_time && same_pixels(a.left, b.left) && same_pixels(a.right, b.right);
}

// Every pixel around shows the same face: no edge within `reach`.
bool inside_one_surface(const Film& film, int u, int v, int reach) {
  for (int dv = -reach; dv <= reach; ++dv)
    for (int du = -reach; du <= reach; ++du)
      if (film.keys[film.at(u + du, v + dv)] != film.keys[film.at(u, v)]) return false;
  return true;
}

// Median difference of grey between a left pixel and where the truth puts the same surface point, per surface class.
struct Match {
  std::vector<double> seabed, object;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

template <class PixelInOther>
Match match_greys(const SyntheticSource& source, const SourcePair& pair, const Image& other,
                  const PixelInOther& pixel_in_other) {
  constexpr int kReach = 4;
  constexpr int kMovingSolid = 1;  // the crate of small_dive
  const Film& film = source.left_film();
  Match match;
  for (int v = 8; v < film.height - 8; v += 3) {
    for (int u = 8; u < film.width - 8; u += 3) {
      if (!inside_one_surface(film, u, v, kReach)) continue;
      const int solid = solid_of_key(film.keys[film.at(u, v)]);
      const auto grey = grey_at(other, pixel_in_other(p_cam_at(source, u, v), solid == kMovingSolid));
      if (!grey) continue;
      const double difference = std::abs(*grey - pair.left.row(v)[u]);
      if (solid == kMovingSolid) match.object.push_back(difference);
      if (solid < 0) match.seabed.push_back(difference);
    }
  }
  return match;
}

TEST(Renderer, DepthOfTheSeabedSatisfiesItsHeightField) {
  Scene scene = small_dive();
  scene.seabed.rocks_per_m2 = 0;
  SyntheticSource source(scene);
  SourcePair pair;
  source.render(3, pair);
  const Seafloor floor(scene.seabed, scene.seed);
  int checked = 0;
  for (int v = 0; v < scene.camera.height_px; v += 5) {
    for (int u = 0; u < scene.camera.width_px; u += 5) {
      if (source.left_film().keys[source.left_film().at(u, v)] != 0) continue;
      const Eigen::Vector3d p_sea = scene.T_sea_cam(3) * p_cam_at(source, u, v);
      const float z = floor.z_at(static_cast<float>(p_sea.x()), static_cast<float>(p_sea.y()));
      ASSERT_NEAR(static_cast<double>(z), p_sea.z(), 1e-5) << "pixel " << u << ", " << v;
      ++checked;
    }
  }
  EXPECT_GT(checked, 1000);
}

TEST(Renderer, SeabedInViewIsTheNearestOneEvenWhereItHidesItself) {
  Scene scene = small_dive();
  scene.bodies.clear();
  scene.seabed.rocks_per_m2 = 0;
  scene.seabed.relief_m = 2.5;  // hills that hide the ground behind them
  scene.seabed.relief_wavelength_m = 3;
  scene.camera.look_down_rad = 0.5;
  SyntheticSource source(scene);
  SourcePair pair;
  source.render(0, pair);
  const Seafloor floor(scene.seabed, scene.seed);
  const Rigid3 T_sea_cam = scene.T_sea_cam(0);
  for (int v = 4; v < scene.camera.height_px; v += 9) {
    for (int u = 4; u < scene.camera.width_px; u += 9) {
      const Eigen::Vector3d p_cam = p_cam_at(source, u, v);
      for (double share = 0.02; share < 0.995; share += 0.005) {
        const Eigen::Vector3d p_sea = T_sea_cam * (share * p_cam);
        ASSERT_LT(p_sea.z(),
                  static_cast<double>(floor.z_at(static_cast<float>(p_sea.x()), static_cast<float>(p_sea.y()))) + 1e-3)
            << "the ray of pixel " << u << ", " << v << " went through a hill at " << share;
      }
    }
  }
}

TEST(Renderer, RightImageShowsTheSameSurfaceAtThePredictedDisparity) {
  SyntheticSource source(small_dive());
  SourcePair pair;
  source.render(5, pair);
  const SceneCamera& camera = source.scene().camera;
  const auto with_error = [&](double error_px) {
    return match_greys(source, pair, pair.right, [&](const Eigen::Vector3d& p_cam, bool) {
      const Eigen::Vector3d p_right = p_cam - Eigen::Vector3d(camera.baseline_m, 0, 0);
      return Eigen::Vector2d(project(camera, p_right) + Eigen::Vector2d(error_px, 0));
    });
  };
  const Match right = with_error(0);
  ASSERT_GT(right.seabed.size(), 1000U);
  ASSERT_GT(right.object.size(), 100U);
  // What remains is rounding to whole greys and interpolation; a tenth of a pixel already shows.
  EXPECT_LT(median(right.seabed), 1.0);
  EXPECT_LT(median(right.object), 1.0);
  for (const double error_px : {-0.25, 0.25}) {
    EXPECT_GT(median(with_error(error_px).seabed), 1.5 * median(right.seabed));
    EXPECT_GT(median(with_error(error_px).object), 1.5 * median(right.object));
  }
}

TEST(Renderer, TruthCarriesASurfacePointToItsPlaceFiveFramesLater) {
  SyntheticSource source(small_dive());
  constexpr int kFrame = 4;
  constexpr int kLater = 9;
  SourcePair pair;
  SourcePair later;
  source.render(kLater, later);
  source.render(kFrame, pair);
  const Rigid3 T_later_cam = source.T_world_cam(kLater).inverse() * source.T_world_cam(kFrame);
  const Rigid3 M_world = source.T_world_obj(0, kLater) * source.T_world_obj(0, kFrame).inverse();
  const auto place = [&](const Rigid3& M, const Eigen::Vector3d& p_cam) {
    return project(source.scene().camera,
                   source.T_world_cam(kLater).inverse() * (M * (source.T_world_cam(kFrame) * p_cam)));
  };
  const Match with_truth = match_greys(source, pair, later.left, [&](const Eigen::Vector3d& p_cam, bool moving) {
    return place(moving ? M_world : Rigid3::Identity(), p_cam);
  });
  const Match as_if_static = match_greys(source, pair, later.left, [&](const Eigen::Vector3d& p_cam, bool) {
    return project(source.scene().camera, T_later_cam * p_cam);
  });
  // Shading and the pixel's footprint change a little along the way.
  EXPECT_LT(median(with_truth.seabed), 1.5);
  EXPECT_LT(median(with_truth.object), 2.5);
  EXPECT_GT(median(as_if_static.object), 4 * median(with_truth.object));
}

TEST(Renderer, TruthStartsAtTheFirstLeftCamera) {
  SyntheticSource source(small_dive());
  EXPECT_LT((source.T_world_cam(0).matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
  EXPECT_EQ(source.object_count(), 1);  // the pillar stands still
  EXPECT_EQ(source.object_body(0).name, "crate");
}

TEST(Renderer, AHalfSizePictureIsTheFullOneAveragedSoTextureDoesNotAlias) {
  Scene scene = small_dive();
  SyntheticSource full(scene);
  scene.camera.width_px /= 2;
  scene.camera.height_px /= 2;
  scene.camera.f_px /= 2;  // pixel (u, v) covers pixels 2u, 2u + 1 and 2v, 2v + 1 of the full one
  SyntheticSource half(scene);
  SourcePair pair_full;
  SourcePair pair_half;
  full.render(0, pair_full);
  half.render(0, pair_half);
  double sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
  const double count = scene.camera.width_px * scene.camera.height_px;
  for (int v = 0; v < scene.camera.height_px; ++v) {
    const std::uint8_t* upper = pair_full.left.row(2 * v);
    const std::uint8_t* lower = pair_full.left.row(2 * v + 1);
    for (int u = 0; u < scene.camera.width_px; ++u) {
      const double a = pair_half.left.row(v)[u];
      const double b = 0.25 * (upper[2 * u] + upper[2 * u + 1] + lower[2 * u] + lower[2 * u + 1]);
      sum_a += a, sum_b += b, sum_aa += a * a, sum_bb += b * b, sum_ab += a * b;
    }
  }
  const double correlation =
      (sum_ab - sum_a * sum_b / count) / std::sqrt((sum_aa - sum_a * sum_a / count) * (sum_bb - sum_b * sum_b / count));
  EXPECT_GT(correlation, 0.85);  // 0.66 without the fading of fine octaves
}

Scene ball_ahead(const Eigen::Vector3d& p_cam, double radius_m) {
  Scene scene = small_dive();
  scene.vehicle = path_through({{0, 0, 0}}, {{0, 0, 0}});
  Body ball;
  ball.shape = Shape::ellipsoid;
  ball.size_m.setConstant(2 * radius_m);
  const Eigen::Vector3d p_sea = scene.T_sea_cam(0) * p_cam;
  ball.path = path_through({p_sea, p_sea + Eigen::Vector3d(0.1, 0, 0)}, {{0, 0, 0}});
  scene.bodies = {ball};
  return scene;
}

TEST(Renderer, VisiblePixelsOfABallAreTheAreaOfItsImage) {
  constexpr double kRadiusM = 0.4;
  constexpr double kDistanceM = 2.2;
  SyntheticSource source(ball_ahead({0, 0, kDistanceM}, kRadiusM));
  SourcePair pair;
  source.render(0, pair);
  const double f_px = source.scene().camera.f_px;
  const double radius_px = f_px * kRadiusM / std::sqrt(kDistanceM * kDistanceM - kRadiusM * kRadiusM);
  const double area_px = std::numbers::pi * radius_px * radius_px;
  EXPECT_NEAR(source.visible_px(0), area_px, 0.005 * area_px);
}

TEST(Renderer, ABodyOutOfViewBehindOrHiddenHasNoVisiblePixels) {
  SourcePair pair;
  SyntheticSource beside(ball_ahead({3, 0, 2}, 0.3));
  beside.render(0, pair);
  EXPECT_EQ(beside.visible_px(0), 0);
  SyntheticSource behind(ball_ahead({0, 0, -1}, 0.3));
  behind.render(0, pair);
  EXPECT_EQ(behind.visible_px(0), 0);
  Scene scene = ball_ahead({0, 0, 2.4}, 0.2);
  Body wall;
  wall.size_m = {1.5, 1.5, 1.5};
  wall.path = path_through({scene.T_sea_cam(0) * Eigen::Vector3d(0, 0, 1.3)}, {{0, 0, 0}});
  scene.bodies.insert(scene.bodies.begin(), wall);  // drawn first: the ball must not paint over it
  SyntheticSource hidden(scene);
  hidden.render(0, pair);
  EXPECT_EQ(hidden.visible_px(0), 0);
}

TEST(Renderer, OutlineOfABallLiesAtItsSubPixelPlace) {
  // The brightness that the ball covers, along the row through its middle, must move with the ball by fractions of a
  // pixel: each edge pixel mixes both sides.
  const auto covered_px = [](double x_m) {
    Scene scene = ball_ahead({x_m, 0, 2.0}, 0.3);
    scene.seabed.contrast = 0;
    scene.seabed.rocks_per_m2 = 0;
    scene.seabed.brightness = 0.1;
    scene.seabed.relief_m = 0;
    scene.bodies[0].contrast = 0;
    scene.bodies[0].brightness = 1.5;
    scene.light.ambient = 1;
    scene.sensor.gain = 250;
    SyntheticSource source(scene);
    SourcePair pair;
    source.render(0, pair);
    const std::uint8_t* row = pair.left.row(120);
    double sum = 0;
    for (int u = 160; u < 320; ++u) sum += row[u];  // right half only: one edge
    return (sum - 160.0 * row[319]) / (row[165] - row[319]);
  };
  constexpr double kPixelM = 2.0 / 250.0;
  const double at_zero = covered_px(0);
  for (const double shift_px : {0.25, 0.5, 0.75, 1.0}) {
    EXPECT_NEAR(covered_px(shift_px * kPixelM) - at_zero, shift_px, 0.13) << "shift " << shift_px;
  }
}

TEST(Renderer, SameBytesWhateverTheNumberOfThreadsAndTheOrderOfFrames) {
  Scene scene = small_dive();
  scene.sensor = Sensor{};
  scene.water.snow_per_m3 = 20;
  scene.water.blur_px_per_m = 0.2;
  scene.light.carried = 0.5;
  SyntheticSource one_thread(scene, 1);
  SyntheticSource three_threads(scene, 3);
  SourcePair first;
  SourcePair second;
  three_threads.render(7, second);
  three_threads.render(2, second);
  for (int frame = 0; frame < 3; ++frame) {
    const Result<bool> more = one_thread.next(first);
    ASSERT_TRUE(more.ok() && more.value());
  }
  EXPECT_TRUE(same_pair(first, second));
}

TEST(Renderer, AnotherSeedMakesAnotherWorld) {
  Scene scene = small_dive();
  SyntheticSource source(scene);
  scene.reseed(scene.seed + 1);
  SyntheticSource other(scene);
  SourcePair a;
  SourcePair b;
  source.render(0, a);
  other.render(0, b);
  EXPECT_FALSE(same_pair(a, b));
}

TEST(Renderer, SensorNoiseHasTheStatedDeviationAndDiffersBetweenExposures) {
  Scene scene = small_dive();
  scene.vehicle = path_through({{0, 0, 0}}, {{0, 0, 0}});
  scene.bodies.pop_back();
  scene.sensor.read_noise_grey = 1.5;
  SyntheticSource source(scene);
  SourcePair a;
  SourcePair b;
  source.render(0, a);
  source.render(1, b);
  double sum2 = 0;
  for (int v = 0; v < a.left.height(); ++v)
    for (int u = 0; u < a.left.width(); ++u) sum2 += std::pow(a.left.row(v)[u] - b.left.row(v)[u], 2);
  const double variance = sum2 / (a.left.height() * a.left.width());
  // Two exposures, each with read noise and with rounding (1/12).
  EXPECT_NEAR(variance, 2 * (1.5 * 1.5 + 1.0 / 12), 0.15);
}

TEST(SyntheticSource, EndsAfterItsFramesAndCountsThem) {
  Scene scene = small_dive();
  scene.frames = 2;
  SyntheticSource source(scene);
  EXPECT_EQ(source.pair_count(), 2U);
  EXPECT_TRUE(source.calibration().rectified);
  EXPECT_DOUBLE_EQ(source.calibration().T_right_left.translation().x(), -0.12);
  SourcePair pair;
  Result<bool> more = source.next(pair);
  EXPECT_TRUE(more.ok() && more.value());
  const Timestamp first = pair.capture_time;
  more = source.next(pair);
  EXPECT_TRUE(more.ok() && more.value());
  EXPECT_EQ(pair.seq, 1U);
  EXPECT_EQ((pair.capture_time - first).count(), 100'000'000);
  more = source.next(pair);
  EXPECT_TRUE(more.ok() && !more.value());
}

}  // namespace
}  // namespace pelorus::synthetic
