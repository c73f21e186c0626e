// Water, snow, lamp and shadows: what they must do to a picture, and what they must leave alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drivers/synthetic/lighting.h"
#include "drivers/synthetic/marine_snow.h"
#include "drivers/synthetic/synthetic_source.h"
#include "tests/drivers/synthetic/small_dive.h"

namespace pelorus::synthetic {
namespace {

SourcePair rendered(const Scene& scene, int frame) {
  SyntheticSource source(scene);
  SourcePair pair;
  source.render(frame, pair);
  return pair;
}

struct Greys {
  double mean = 0;
  double deviation = 0;
};

Greys greys(const Image& image, int v_first, int v_last) {
  double sum = 0;
  double sum2 = 0;
  const double count = static_cast<double>(image.width()) * (v_last - v_first);
  for (int v = v_first; v < v_last; ++v) {
    for (int u = 0; u < image.width(); ++u) {
      sum += image.row(v)[u];
      sum2 += image.row(v)[u] * image.row(v)[u];
    }
  }
  return {sum / count, std::sqrt(std::max(0.0, sum2 / count - sum * sum / (count * count)))};
}

Scene bare_dive() {
  Scene scene = small_dive();
  scene.bodies.clear();
  scene.seabed.rocks_per_m2 = 0;
  return scene;
}

TEST(Water, DecayIsTheExponential) {
  for (float x = 0; x > -20; x -= 0.37F) EXPECT_NEAR(decay(x), std::exp(x), 2e-6F * std::exp(x)) << x;
  EXPECT_EQ(decay(0), 1.0F);
}

// Mean step from pixel to pixel along the rows: fine contrast, blind to slow changes.
double fine_contrast(const Image& image, int v_first, int v_last) {
  double sum = 0;
  for (int v = v_first; v < v_last; ++v)
    for (int u = 1; u < image.width(); ++u) sum += std::abs(image.row(v)[u] - image.row(v)[u - 1]);
  return sum;
}

TEST(Water, AttenuationTakesContrastWithRange) {
  Scene scene = bare_dive();
  scene.camera.look_down_rad = 0.9;  // the upper rows look farther
  const SourcePair clear = rendered(scene, 0);
  scene.water.attenuation_per_m = 0.2;
  const SourcePair murky = rendered(scene, 0);
  const double kept_far = fine_contrast(murky.left, 0, 60) / fine_contrast(clear.left, 0, 60);
  const double kept_near = fine_contrast(murky.left, 180, 240) / fine_contrast(clear.left, 180, 240);
  EXPECT_LT(kept_far, 0.8 * kept_near);
  EXPECT_LT(kept_near, 0.7);
}

TEST(Water, BackscatterBrightensDarkWaterAndNeverBeyondTheVeil) {
  Scene scene = bare_dive();
  scene.seabed.brightness = 0.1;
  const double dark = greys(rendered(scene, 0).left, 0, 240).mean;
  scene.water.backscatter_per_m = 0.2;
  const double veiled = greys(rendered(scene, 0).left, 0, 240).mean;
  EXPECT_GT(veiled, dark + 5);
  EXPECT_LT(veiled, dark + scene.sensor.gain * scene.water.veil);
}

TEST(Water, BlurTakesFineContrastAndKeepsTheMean) {
  Scene scene = bare_dive();
  const Greys sharp = greys(rendered(scene, 0).left, 0, 240);
  scene.water.blur_px_per_m = 0.4;
  const Greys soft = greys(rendered(scene, 0).left, 0, 240);
  EXPECT_LT(soft.deviation, 0.8 * sharp.deviation);
  EXPECT_NEAR(soft.mean, sharp.mean, 0.5);
}

TEST(Water, BothCamerasSeeAFlakeAtItsDisparity) {
  Scene scene = bare_dive();
  scene.seabed.brightness = 0.1;
  const SourcePair clear = rendered(scene, 2);
  scene.water.snow_per_m3 = 20;
  scene.water.snow_size_m = 0.012;
  const SourcePair snowing = rendered(scene, 2);
  const Rigid3 T_sea_cam = scene.T_sea_cam(2);
  const auto added = [](const Image& with, const Image& without, const Eigen::Vector2d& uv) {
    const auto a = grey_at(with, uv);
    const auto b = grey_at(without, uv);
    return a && b ? *a - *b : 0.0;
  };
  int seen = 0;
  for (const Flake& flake : drifting_flakes(scene, scene.time_s(2), T_sea_cam)) {
    const Eigen::Vector3d p_cam = T_sea_cam.inverse() * flake.p_sea.cast<double>();
    if (p_cam.z() < 0.4 || p_cam.z() > 1.5) continue;
    const Eigen::Vector2d uv_left = project(scene.camera, p_cam);
    const Eigen::Vector2d uv_right = project(scene.camera, p_cam - Eigen::Vector3d(scene.camera.baseline_m, 0, 0));
    const double left = added(snowing.left, clear.left, uv_left);
    const double right = added(snowing.right, clear.right, uv_right);
    if (left < 4 || uv_right.x() < 3) continue;
    ++seen;
    EXPECT_NEAR(right, left, 0.25 * left + 3);
  }
  EXPECT_GT(seen, 3);
}

TEST(Water, FlakesDriftWithTheCurrentWhileTheVehicleStands) {
  Scene scene = bare_dive();
  scene.water.snow_per_m3 = 30;
  scene.water.snow_drift_m_per_s = 0.1;
  const Rigid3 T_sea_cam = scene.T_sea_cam(0);
  const auto before = drifting_flakes(scene, 0, T_sea_cam);
  const auto after = drifting_flakes(scene, 0.05, T_sea_cam);
  Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();
  int followed = 0;
  for (const Flake& flake : before) {
    // A flake keeps its size, which tells it from its neighbours.
    for (const Flake& later : after) {
      if (later.size_m != flake.size_m) continue;
      const Eigen::Vector3d step_m = (later.p_sea - flake.p_sea).cast<double>();
      if (step_m.norm() > 0.05) continue;
      moved_m += step_m;
      ++followed;
    }
  }
  EXPECT_GT(followed, static_cast<int>(before.size()) * 3 / 4);
  // 5 mm in 0.05 s along the current; the eddies average out.
  EXPECT_NEAR((moved_m / followed).norm(), 0.005, 0.001);
}

TEST(Light, CarriedLampLightsTheMiddleMoreThanTheCorners) {
  Scene scene = bare_dive();
  scene.seabed.contrast = 0;
  scene.camera.look_down_rad = 1.5707;
  scene.light.daylight = 0;
  scene.light.carried = 1;
  scene.light.beam_rad = 0.3;
  const Image image = rendered(scene, 0).left;
  const double middle = image.row(120)[160];
  for (const int u : {2, 317})
    for (const int v : {2, 237}) EXPECT_LT(image.row(v)[u], 0.6 * middle);
}

TEST(Light, ShadowOfABodyDarkensTheSeabedOnly) {
  Scene scene = small_dive();
  const SourcePair lit = rendered(scene, 0);
  scene.light.shadow = 1;
  const SourcePair shaded = rendered(scene, 0);
  int darker = 0;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      ASSERT_LE(shaded.left.row(v)[u], lit.left.row(v)[u]);
      darker += shaded.left.row(v)[u] + 10 < lit.left.row(v)[u] ? 1 : 0;
    }
  }
  EXPECT_GT(darker, 500);
  EXPECT_LT(darker, 320 * 240 / 2);
}

}  // namespace
}  // namespace pelorus::synthetic
