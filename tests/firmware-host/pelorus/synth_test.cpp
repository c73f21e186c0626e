#include "firmware-host/pelorus/synth/synth.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <sstream>

#include "drivers/replay/dataset.h"
#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = R"(name: tiny
seed: 9
frames: 3
camera: {width_px: 96, height_px: 64, f_px: 75, baseline_m: 0.15, rate_hz: 5}
vehicle: {p_m: [[0, 0, 0], [1, 0, 0]], rpy_deg: [[0, 0, 0], [0, 0, 40]]}
bodies:
  - name: post
    size_m: [0.3, 0.3, 0.3]
    path: {p_m: [1, 1, 2.5]}
  - name: crate
    size_m: [0.5, 0.5, 0.5]
    path: {p_m: [[1, 0, 2.5], [1.4, 0, 2.5]]}
)";

Result<int> run_synth(std::vector<std::string> arguments) {
  CLI::App app;
  const Verb verb = add_synth(app);
  arguments.insert(arguments.begin(), "synth");
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  app.parse(arguments);
  return verb.run();
}

class Synth : public ::testing::Test {
 protected:
  void SetUp() override { test::write_text(scene_, kScene); }
  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator{}));
  }

  test::TemporaryFolder folder_;
  const fs::path scene_ = folder_.path() / "tiny.yaml";
  const fs::path out_ = folder_.path() / "dive";
};

std::vector<std::vector<double>> rows(const fs::path& csv) {
  std::istringstream lines(test::read_text(csv));
  std::vector<std::vector<double>> table;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    table.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) table.back().push_back(std::stod(field));
  }
  return table;
}

Rigid3 pose_of(const std::vector<double>& row) {
  Rigid3 T = Rigid3::Identity();
  T.translation() = Eigen::Vector3d(row[1], row[2], row[3]);
  T.linear() = Eigen::Quaterniond(row[4], row[5], row[6], row[7]).toRotationMatrix();
  return T;
}

TEST_F(Synth, WhatItWritesReadsBackAsTheSamePixelsAndCalibration) {
  const Result<int> outcome = run_synth({scene_.string(), "--out", out_.string()});
  ASSERT_TRUE(outcome.ok()) << outcome.error().message();
  EXPECT_EQ(outcome.value(), 0);
  Result<std::unique_ptr<StereoSource>> recorded = open_dataset(out_);
  ASSERT_TRUE(recorded.ok()) << recorded.error().message();
  const StereoCalibration& calibration = recorded.value()->calibration();
  EXPECT_DOUBLE_EQ(calibration.left.fx_px, 75);
  EXPECT_DOUBLE_EQ(calibration.left.cx_px, 47.5);
  EXPECT_NEAR(calibration.T_right_left.translation().x(), -0.15, 1e-12);
  EXPECT_LT(rotation_angle_rad(calibration.T_right_left.linear()), 1e-15) << "nothing to rectify";
  EXPECT_EQ(recorded.value()->pair_count(), 3U);

  synthetic::SyntheticSource rendered(synthetic::load_scene(scene_.string()).value());
  SourcePair read;
  SourcePair expected;
  for (int frame = 0; frame < 3; ++frame) {
    Result<bool> more = recorded.value()->next(read);
    ASSERT_TRUE(more.ok() && more.value());
    rendered.render(frame, expected);
    EXPECT_EQ(read.capture_time, expected.capture_time);
    for (int v = 0; v < 64; ++v) {
      ASSERT_TRUE(std::equal(read.left.row(v), read.left.row(v) + 96, expected.left.row(v)));
      ASSERT_TRUE(std::equal(read.right.row(v), read.right.row(v) + 96, expected.right.row(v)));
    }
  }
}

TEST_F(Synth, TruthIsWrittenForTheVehicleAndForMovingBodiesOnly) {
  ASSERT_TRUE(run_synth({scene_.string(), "--out", out_.string()}).ok());
  synthetic::SyntheticSource rendered(synthetic::load_scene(scene_.string()).value());
  const auto recorded = open_dataset(out_);
  ASSERT_TRUE(recorded.ok()) << recorded.error().message();
  const Rigid3 T_body_cam = recorded.value()->calibration().T_body_left;
  EXPECT_LT((T_body_cam.matrix() - rendered.scene().camera.T_body_cam().matrix()).norm(), 1e-12);
  const auto vehicle = rows(out_ / "mav0/state_groundtruth_estimate0/data.csv");
  const auto object = rows(out_ / "mav0/object1/data.csv");
  EXPECT_FALSE(fs::exists(out_ / "mav0/object2"));
  ASSERT_EQ(vehicle.size(), 3U);
  ASSERT_EQ(object.size(), 3U);
  for (int frame = 0; frame < 3; ++frame) {
    const auto k = static_cast<std::size_t>(frame);
    EXPECT_LT(((pose_of(vehicle[k]) * T_body_cam).matrix() - rendered.T_world_cam(frame).matrix()).norm(), 1e-9);
    EXPECT_LT((pose_of(object[k]).matrix() - rendered.T_world_obj(0, frame).matrix()).norm(), 1e-9);
    SourcePair pair;
    rendered.render(frame, pair);
    ASSERT_EQ(object[k].size(), 9U);
    EXPECT_EQ(object[k][8], rendered.visible_px(0));
    EXPECT_GT(object[k][8], 0);
  }
}

TEST_F(Synth, AVehicleThatGoesAheadMovesAlongXOfItsBody) {
  ASSERT_TRUE(run_synth({scene_.string(), "--out", out_.string()}).ok());
  const auto vehicle = rows(out_ / "mav0/state_groundtruth_estimate0/data.csv");
  ASSERT_EQ(vehicle.size(), 3U);
  const Eigen::Vector3d step = (pose_of(vehicle[0]).inverse() * pose_of(vehicle[1])).translation();
  EXPECT_NEAR(step.x(), 0.2, 0.01);  // 1 m/s at 5 pairs/s
  EXPECT_LT(step.tail<2>().norm(), 0.01);
}

TEST_F(Synth, FramesAndSeedOverrideTheScene) {
  ASSERT_TRUE(run_synth({scene_.string(), "--out", out_.string(), "--frames", "2"}).ok());
  const fs::path other = folder_.path() / "other";
  ASSERT_TRUE(run_synth({scene_.string(), "--out", other.string(), "--frames", "2", "--seed", "10"}).ok());
  const auto image = [](const fs::path& dive) {
    return test::read_text(dive / "mav0/cam0/data/1600000000000000000.png");
  };
  EXPECT_EQ(rows(out_ / "mav0/object1/data.csv").size(), 2U);
  EXPECT_FALSE(image(out_).empty());
  EXPECT_NE(image(out_), image(other));
}

TEST_F(Synth, ReplacesADiveOfItsOwnWhenToldToAndNothingElse) {
  test::write_text(out_ / "precious.txt", "keep");
  const Result<int> refused = run_synth({scene_.string(), "--out", out_.string()});
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message().find("--overwrite"), std::string::npos);
  EXPECT_EQ(test::read_text(out_ / "precious.txt"), "keep");
  const Result<int> forced = run_synth({scene_.string(), "--out", out_.string(), "--overwrite"});
  ASSERT_FALSE(forced.ok());
  EXPECT_EQ(forced.error().code, ErrorCode::io);
  EXPECT_EQ(test::read_text(out_ / "precious.txt"), "keep");

  const fs::path dive = folder_.path() / "dive_before";
  ASSERT_TRUE(run_synth({scene_.string(), "--out", dive.string()}).ok());
  EXPECT_FALSE(run_synth({scene_.string(), "--out", dive.string()}).ok());
  EXPECT_TRUE(run_synth({scene_.string(), "--out", dive.string(), "--overwrite"}).ok());
  EXPECT_TRUE(run_synth({scene_.string(), "--out", dive.string(), "--force"}).ok()) << "the earlier name";
  EXPECT_TRUE(fs::exists(dive / "mav0/cam1/data.csv"));
}

TEST_F(Synth, AnUnwritablePlaceIsAnErrorThatNamesIt) {
  test::write_text(folder_.path() / "file", "not a folder");
  const Result<int> outcome = run_synth({scene_.string(), "--out", (folder_.path() / "file/dive").string()});
  ASSERT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.error().code, ErrorCode::io);
  EXPECT_NE(outcome.error().message().find((folder_.path() / "file/dive").string()), std::string::npos);
}

TEST_F(Synth, LeavesNothingBesideTheFinishedFolder) {
  test::write_text(out_.string() + ".partial/old.txt", "left by a run that was broken off");
  ASSERT_TRUE(run_synth({scene_.string(), "--out", out_.string() + "/"}).ok());
  EXPECT_EQ(entries(), 2U);  // the scene and the dive
  EXPECT_FALSE(fs::exists(out_ / "old.txt"));
}

TEST_F(Synth, ABadSceneIsReportedBeforeAnythingIsWritten) {
  test::write_text(scene_, std::string(kScene) + "watr: {}\n");
  const Result<int> outcome = run_synth({scene_.string(), "--out", out_.string()});
  ASSERT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.error().code, ErrorCode::bad_configuration);
  EXPECT_NE(outcome.error().message().find("tiny.yaml:13: unknown key 'watr'"), std::string::npos);
  EXPECT_EQ(entries(), 1U);
}

TEST_F(Synth, AnUnknownSceneNameIsAUsageError) {
  const Result<int> outcome = run_synth({"no_such_scene", "--out", out_.string()});
  ASSERT_FALSE(outcome.ok());
  EXPECT_EQ(exit_code(outcome.error().code), 2);
  EXPECT_FALSE(fs::exists(out_));
}

}  // namespace
}  // namespace pelorus
