#include "drivers/synthetic/scene_file.h"

#include <gtest/gtest.h>

namespace pelorus::synthetic {
namespace {

constexpr const char* kGood = R"(name: small
seed: 5
frames: 12
vehicle:
  p_m: [[0, 0, 0], [1, 0, 0]]
bodies:
  - name: crate
    shape: box
    size_m: [0.5, 0.4, 0.3]
    path: {p_m: [1, 0, 2], rpy_deg: [0, 0, 90]}
)";

std::string error_of(const std::string& yaml) {
  const Result<Scene> scene = parse_scene(yaml, "dive.yaml");
  return scene.ok() ? "" : scene.error().message();
}

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in:\n" << text;
}

TEST(SceneFile, ReadsValuesInTheUnitsTheKeysName) {
  const Result<Scene> scene = parse_scene(kGood, "dive.yaml");
  ASSERT_TRUE(scene.ok()) << scene.error().message();
  EXPECT_EQ(scene.value().name, "small");
  EXPECT_EQ(scene.value().seed, 5U);
  EXPECT_EQ(scene.value().frames, 12);
  ASSERT_EQ(scene.value().bodies.size(), 1U);
  EXPECT_NEAR(scene.value().bodies[0].path.rpy_rad[0].z(), 1.5707963, 1e-6);
  EXPECT_TRUE(scene.value().bodies[0].path.stands_still());
  EXPECT_EQ(scene.value().camera.width_px, 1024);
}

TEST(SceneFile, NamesFileLineAndKnownKeysForAnUnknownKey) {
  const std::string error = error_of(std::string(kGood) + "seabed:\n  dept_m: 3\n");
  expect_in(error, "dive.yaml:12: unknown key 'seabed.dept_m'");
  expect_in(error, "depth_m");
}

TEST(SceneFile, ListsAllProblemsAtOnce) {
  const std::string error = error_of(R"(frames: many
camera:
  f_px: 3
  width_px: 100.5
vehicle:
  p_m: [[0, 0, 0], [1, 0]]
bodies:
  - shape: pyramid
    size_m: [1, 1, -1]
water: 3
)");
  expect_in(error, "dive.yaml:1: 'frames' has to be a number");
  expect_in(error, "dive.yaml:3: 'camera.f_px' is 3: give a value from 50 to 10000");
  expect_in(error, "dive.yaml:4: 'camera.width_px' has to be a whole number");
  expect_in(error, "dive.yaml:6: 'vehicle.p_m[1]' has to be three numbers");
  expect_in(error, "dive.yaml:8: 'bodies[0].shape' is 'pyramid': use box or ellipsoid");
  expect_in(error, "dive.yaml:9: 'bodies[0].size_m' is -1");
  expect_in(error, "dive.yaml:8: 'bodies[0].path' is missing");
  expect_in(error, "dive.yaml:10: water has to be a list");
}

TEST(SceneFile, RefusesAKeyGivenTwice) {
  expect_in(error_of(std::string(kGood) + "frames: 13\n"), "dive.yaml:11: 'frames' is given twice");
}

TEST(SceneFile, RefusesAsManyAnglesAsNeitherOneNorThePoints) {
  expect_in(error_of("vehicle:\n  p_m: [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\n  rpy_deg: [[0, 0, 0], [1, 0, 0]]\n"),
            "dive.yaml:3: 'vehicle.rpy_deg' has 2 entries");
}

TEST(SceneFile, RefusesNumbersThatAreNone) {
  expect_in(error_of("vehicle: {p_m: [0, .nan, 0]}\n"), "has to be a number");
  expect_in(error_of("seed: -1\nvehicle: {p_m: [0, 0, 0]}\n"), "dive.yaml:1: 'seed' has to be a whole number");
}

TEST(SceneFile, ReportsBrokenYamlWithItsLine) {
  expect_in(error_of("name: x\nvehicle: [1, 2\n"), "dive.yaml:3: not valid YAML");
  expect_in(error_of("just words\n"), "dive.yaml:1: the file has to be a list of 'key: value'");
  expect_in(error_of(""), "dive.yaml:1: the file has to be a list");
}

TEST(SceneFile, ReportsAFileThatCannotBeRead) {
  const Result<Scene> scene = load_scene("/nowhere/dive.yaml");
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, ErrorCode::io);
  expect_in(scene.error().message(), "/nowhere/dive.yaml: cannot be read");
}

}  // namespace
}  // namespace pelorus::synthetic
