// The scenes of config/scenes keep their promises. Rendered at a quarter of the size.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"

namespace pelorus::synthetic {
namespace {

Scene shipped(const std::string& name) {
  const Result<Scene> scene = load_scene(std::string(PELORUS_SOURCE_DIR "/config/scenes/") + name + ".yaml");
  EXPECT_TRUE(scene.ok()) << scene.error().message();
  return scene.ok() ? scene.value() : Scene{};
}

Scene quarter_size(Scene scene) {
  scene.camera.width_px /= 4;
  scene.camera.height_px /= 4;
  scene.camera.f_px /= 4;
  scene.sensor.shot_noise = 0;
  return scene;
}

double visible_share(const SyntheticSource& source, int object) {
  const SceneCamera& camera = source.scene().camera;
  return static_cast<double>(source.visible_px(object)) / (camera.width_px * camera.height_px);
}

double speed_m_per_s(const SyntheticSource& source, int object, int frame) {
  return (source.T_world_obj(object, frame + 1).translation() - source.T_world_obj(object, frame).translation())
             .norm() *
         source.scene().camera.rate_hz;
}

TEST(ShippedScenes, AllLoadAndAreNamedLikeTheirFile) {
  for (const auto& [folder, least] : {std::pair("/config/scenes", 7), std::pair("/tests/golden", 4)}) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(std::string(PELORUS_SOURCE_DIR) + folder)) {
      if (entry.path().extension() != ".yaml") continue;
      const Result<Scene> scene = load_scene(entry.path().string());
      ASSERT_TRUE(scene.ok()) << scene.error().message();
      EXPECT_EQ(scene.value().name, entry.path().stem().string());
      ++count;
    }
    EXPECT_GE(count, least) << folder;
  }
}

// A grid of points on the surface of a's box lies outside b by more than the margin.
bool apart(const Body& a, const Body& b, double t_s, double margin_m) {
  const Rigid3 T_b_a = b.path.T_sea_b(t_s).inverse() * a.path.T_sea_b(t_s);
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      for (int k = 0; k <= kSteps; ++k) {
        const Eigen::Vector3d unit(i / (0.5 * kSteps) - 1, j / (0.5 * kSteps) - 1, k / (0.5 * kSteps) - 1);
        if (unit.cwiseAbs().maxCoeff() < 1) continue;  // inside
        const Eigen::Vector3d p_b = T_b_a * Eigen::Vector3d(0.5 * unit.cwiseProduct(a.size_m));
        if ((p_b.cwiseAbs() - 0.5 * b.size_m).maxCoeff() < margin_m) return false;
      }
    }
  }
  return true;
}

TEST(ShippedScenes, BodiesNeverTouchEachOtherOrTheGround) {
  for (const char* name : {"paper", "appear_occlude_stop", "large_body", "abreast", "turbid", "five", "shapes"}) {
    const Scene scene = shipped(name);
    const Seafloor floor(scene.seabed, scene.seed);
    for (int frame = 0; frame < scene.frames; frame += 5) {
      const double t_s = scene.time_s(frame);
      for (const Body& a : scene.bodies) {
        const Eigen::Vector3d p = a.path.T_sea_b(t_s).translation();
        EXPECT_LT(p.z() + 0.5 * a.size_m.minCoeff(),
                  static_cast<double>(floor.z_at(static_cast<float>(p.x()), static_cast<float>(p.y()))))
            << name << ": " << a.name << " in the ground at frame " << frame;
        for (const Body& b : scene.bodies) {
          if (&a == &b) continue;
          EXPECT_TRUE(apart(a, b, t_s, 0.02)) << name << ": " << a.name << ", " << b.name << " at " << frame;
        }
      }
    }
  }
}

TEST(ShippedScenes, PaperHasThreeBoxesAtHalfAMetrePerSecondInViewAllTheTime) {
  SyntheticSource source(quarter_size(shipped("paper")));
  ASSERT_EQ(source.object_count(), 3);
  SourcePair pair;
  double path_m = 0;
  for (int frame = 0; frame + 1 < source.scene().frames; ++frame) {
    path_m += (source.T_world_cam(frame + 1).translation() - source.T_world_cam(frame).translation()).norm();
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(speed_m_per_s(source, k, frame), 0.5, 0.1) << frame;
    if (frame % 6 != 0) continue;
    source.render(frame, pair);
    for (int k = 0; k < 3; ++k) EXPECT_GT(visible_share(source, k), 0.02) << "object " << k << " at " << frame;
  }
  EXPECT_GT(path_m, 4);
  EXPECT_LT(path_m, 5);
}

TEST(ShippedScenes, NothingMovesInStaticForThreeHundredFrames) {
  const Scene scene = shipped("static");
  EXPECT_EQ(scene.frames, 300);
  for (const Body& body : scene.bodies) EXPECT_TRUE(body.path.stands_still());
  EXPECT_EQ(scene.light.caustics, 0);
}

TEST(ShippedScenes, LargeBodyFillsThirtyToFiftyPercentForSixSeconds) {
  SyntheticSource source(quarter_size(shipped("large_body")));
  SourcePair pair;
  int large = 0;
  for (int frame = 0; frame < source.scene().frames; frame += 5) {
    source.render(frame, pair);
    const double share = visible_share(source, 0);
    EXPECT_LT(share, 0.5);
    large += share > 0.3 ? 5 : 0;
  }
  EXPECT_GE(large, 60);
}

TEST(ShippedScenes, DiverIsHiddenForTwoSecondsAndComesBackLateAppearsSledgeStops) {
  SyntheticSource source(quarter_size(shipped("appear_occlude_stop")));
  ASSERT_EQ(source.object_count(), 3);  // the pillar is part of the world
  SourcePair pair;
  int hidden = 0;
  int resting = 0;
  for (int frame = 40; frame < 90; frame += 2) {
    source.render(frame, pair);
    hidden += source.visible_px(0) == 0 ? 2 : 0;
    resting += speed_m_per_s(source, 2, frame) < 1e-9 ? 2 : 0;
    EXPECT_TRUE(frame > 50 || source.visible_px(1) == 0);  // "late" is not there at the beginning
  }
  EXPECT_GE(hidden, 17);
  EXPECT_LE(hidden, 24);
  EXPECT_GT(visible_share(source, 0), 0.01);
  EXPECT_GT(visible_share(source, 1), 0.01);
  EXPECT_GE(resting, 20);
  EXPECT_GT(speed_m_per_s(source, 2, 150), 0.2);
}

TEST(ShippedScenes, AbreastBodiesHaveTheSameMotion) {
  SyntheticSource source(quarter_size(shipped("abreast")));
  for (int frame = 1; frame < source.scene().frames; ++frame) {
    const Rigid3 M_port = source.T_world_obj(0, frame) * source.T_world_obj(0, frame - 1).inverse();
    const Rigid3 M_starboard = source.T_world_obj(1, frame) * source.T_world_obj(1, frame - 1).inverse();
    ASSERT_LT((M_port.matrix() - M_starboard.matrix()).norm(), 1e-9) << frame;
  }
}

}  // namespace
}  // namespace pelorus::synthetic
