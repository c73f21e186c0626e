// The service as a process of its own: recorded pairs in, messages on the bus out; faults become states and end.
#include <gtest/gtest.h>

#include <bot_core/image_t.hpp>
#include <bot_core/pose_t.hpp>
#include <fstream>
#include <pelorus/vis_tracks_t.hpp>

#include "core/geometry/transform.h"
#include "drivers/replay/dataset.h"
#include "firmware-host/pelorus/eval/eval_truth.h"
#include "firmware-host/pelorus/replay/replay_run.h"
#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/pelorus/results/result_reader.h"
#include "tests/firmware-host/pelorusd/running_service.h"

namespace pelorus {
namespace {

using test::kForever;
using test::kPatient;
using test::RunningService;
using test::TemporaryFolder;

class EndToEnd : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::lcm_available()) GTEST_SKIP() << "no multicast route: ip route add 224.0.0.0/4 dev lo";
  }
};

EstimatedRun stepped_run() {
  const TemporaryFolder folder;
  auto source = open_dataset(test::rendered_dive());
  EXPECT_TRUE(source.ok()) << source.error().message();
  ReplayOptions options;
  options.out_folder = folder.path();
  EXPECT_TRUE(run_replay(*source.value(), options).ok());
  const auto run = read_run(folder.path());
  EXPECT_TRUE(run.ok()) << run.error().message();
  return run.value();
}

// Velocities are those of the dive's truth within the covariance that each message declares, and that covariance is not
// cautious at will. The largest of 24 chi-squares of three degrees stays below 23.0 in 999 of 1000 dives. A point has
// 0.25 px of noise in each of two pictures, at the depth of the seabed and along each of three axes: a step of n points
// is known to that over sqrt(n) at least. With 100 points this is 5 mm/s, and the largest error 5 sqrt(23) = 24 mm/s.
void expect_true_velocities(const std::vector<vis_odom_t>& live, const EstimatedRun& run, const Rigid3& T_body_cam) {
  constexpr double kMostOf24 = 23.0;
  constexpr double kPixelNoise_px = 0.25, kDepth_m = 3.2, kFocal_px = 400;  // both of the scene
  const auto truth = read_truth(test::rendered_dive().string(), "", run);
  ASSERT_TRUE(truth.ok() && truth.value()) << "the dive has its truth";
  const auto& frames = truth.value()->frames;
  for (std::size_t i = 1; i < live.size(); ++i) {
    const Rigid3 T_prev_curr = frames[i - 1].T_truth_cam->inverse() * *frames[i].T_truth_cam;
    const Vector6d twist = se3_log(T_body_cam * T_prev_curr * T_body_cam.inverse()) * test::kDiveRate_hz;
    const Eigen::Vector3d error = Eigen::Vector3d(live[i].vel_body_mps) - twist.head<3>();
    const Eigen::Matrix3d cov = Eigen::Map<const Matrix6d>(live[i].cov_velocity).topLeftCorner<3, 3>();
    const double chi2 = error.dot(cov.llt().solve(error));
    EXPECT_LT(chi2, kMostOf24) << "pair " << i << ", off by " << error.transpose();
    const double sigma_m = kPixelNoise_px * kDepth_m / kFocal_px * std::sqrt(2 * 3.0 / live[i].points_static);
    EXPECT_LT(std::sqrt(cov.trace()), sigma_m * test::kDiveRate_hz) << "pair " << i;
  }
}

TEST_F(EndToEnd, EveryPairInIsOneResultOutEqualToSteppedReplay) {
  const EstimatedRun stepped = stepped_run();
  const auto source = open_dataset(test::rendered_dive());
  ASSERT_TRUE(source.ok()) << source.error().message();
  const Eigen::Matrix3d R_body_cam = source.value()->calibration().T_body_left.linear();
  RunningService service(test::rendered_dive(), kPatient, 1);
  test::Listener<vis_tracks_t> tracks(service.url(), "TEST.VIS_TRACKS");
  test::Listener<bot_core::pose_t> poses(service.url(), "TEST.POSE_BODY");
  test::Listener<bot_core::image_t> images(service.url(), "TEST.VIS_IMAGE_LEFT");
  EXPECT_EQ(service.finish(), 0) << service.log();
  const auto& live = service.odom.messages;
  ASSERT_EQ(live.size(), stepped.size()) << service.log();
  ASSERT_EQ(live.size(), static_cast<std::size_t>(test::kDiveFrames));
  for (std::size_t i = 0; i < live.size(); ++i) {
    EXPECT_EQ(live[i].seq, static_cast<std::int64_t>(i) + 1);
    EXPECT_GE(live[i].latency_ms, 400);
    EXPECT_EQ(live[i].state_text, to_text(stepped[i].state));
    ASSERT_EQ(live[i].pose_valid, stepped[i].T_world_cam.has_value());
    if (!live[i].pose_valid) continue;
    // The files hold nine decimals; live stamps hold the recorded intervals exactly.
    const Eigen::Vector3d difference =
        Eigen::Vector3d(live[i].pos_m) - R_body_cam * stepped[i].T_world_cam->translation();
    EXPECT_LT(difference.norm(), 1e-6) << "pair " << i;
    const std::int64_t interval_us = i > 0 ? live[i].utime - live[i - 1].utime : 100'000;
    EXPECT_NEAR(static_cast<double>(interval_us), 1e6 / test::kDiveRate_hz, 1.5);
  }
  expect_true_velocities(live, stepped, source.value()->calibration().T_body_left);
  tracks.wait_for(live.size(), 1);
  const auto moving = static_cast<std::size_t>(
      std::count_if(live.begin(), live.end(), [](const vis_odom_t& m) { return m.velocity_valid; }));
  EXPECT_EQ(moving, live.size() - 1) << "all but the first";
  poses.wait_for(live.size(), 1);  // one more would be one too many
  images.wait_for(2, 1);
  ASSERT_EQ(tracks.messages.size(), live.size());
  EXPECT_EQ(poses.messages.size(), moving);
  for (std::size_t i = 0; i < live.size(); ++i) {
    EXPECT_EQ(tracks.messages[i].n_tracks, static_cast<int>(stepped[i].objects.size())) << "pair " << i;
  }
  EXPECT_GE(images.messages.size(), 2U);
  for (const bot_core::image_t& image : images.messages) EXPECT_LE(image.size, 60000);
  ASSERT_FALSE(service.health.messages.empty());
  const vis_health_t& health = service.health.messages.back();
  EXPECT_EQ(health.dropped_in_source + health.dropped_ring_full + health.dropped_superseded + health.results_dropped,
            0);
}

// Index of the first message of that state and reason.
std::size_t first_of(const std::vector<vis_odom_t>& all, const std::string& state, const std::string& reason) {
  std::size_t i = 0;
  while (i < all.size() && (all[i].state_text != state || (!reason.empty() && all[i].reason_text != reason))) ++i;
  return i;
}

// Runs of messages of that state and reason.
std::int64_t spells_of(const std::vector<vis_odom_t>& all, const std::string& state, const std::string& reason) {
  std::int64_t spells = 0;
  bool inside = false;
  for (const vis_odom_t& m : all) {
    const bool matches = m.state_text == state && m.reason_text == reason;
    spells += matches && !inside;
    inside = matches;
  }
  return spells;
}

void expect_invalid_numbers(const vis_odom_t& m) {
  EXPECT_FALSE(m.pose_valid || m.velocity_valid);
  EXPECT_TRUE(std::isnan(m.pos_m[0]) && std::isnan(m.vel_body_mps[0]) && std::isnan(m.step_pos_m[0]));
}

TEST_F(EndToEnd, FrozenPicturesAreACameraFaultAndEndByThemselves) {
  const TemporaryFolder folder;
  const auto dive = test::copied_dive(folder);
  constexpr std::size_t kFrozen = 8, kThawed = 14;
  for (int camera = 0; camera < 2; ++camera) {
    const auto files = test::pictures(dive, camera);
    for (std::size_t i = kFrozen; i < kThawed; ++i) {
      std::filesystem::copy_file(files[kFrozen - 1], files[i], std::filesystem::copy_options::overwrite_existing);
    }
  }
  RunningService service(dive, kPatient, 2);
  EXPECT_EQ(service.finish(), 0) << service.log();
  const auto& live = service.odom.messages;
  ASSERT_EQ(live.size(), static_cast<std::size_t>(test::kDiveFrames)) << service.log();
  const std::size_t fault = first_of(live, "CAMERA_FAULT", "pictures frozen");
  EXPECT_LT(fault, kFrozen + 5) << service.log();
  for (std::size_t i = kFrozen; i < kThawed; ++i) expect_invalid_numbers(live[i]);
  EXPECT_TRUE(live.back().pose_valid) << service.log();
  EXPECT_NE(service.log().find("CAMERA_FAULT: pictures frozen"), std::string::npos) << service.log();
}

TEST_F(EndToEnd, ALeftCameraThatIsLostIsAFaultAndItsReturnEndsIt) {
  const TemporaryFolder folder;
  const auto dive = test::copied_dive(folder);
  constexpr std::size_t kLost = 8, kBack = 16;
  const auto files = test::pictures(dive, 0);
  for (std::size_t i = kLost; i < kBack; ++i) std::filesystem::remove(files[i]);
  RunningService service(dive, kPatient, 3);
  EXPECT_EQ(service.finish(), 0) << service.log();
  const auto& live = service.odom.messages;
  const std::size_t fault = first_of(live, "CAMERA_FAULT", "no pictures");
  ASSERT_LT(fault, live.size()) << service.log();
  expect_invalid_numbers(live[fault]);
  const double silence_us = static_cast<double>(live[fault].utime - live[kLost - 1].utime);
  EXPECT_LT(silence_us, 5e6 / test::kDiveRate_hz) << "told within 5 pairs";
  const std::size_t back = first_of(live, "DEGRADED", "pairs dropped");
  ASSERT_LT(back, live.size()) << service.log();
  EXPECT_EQ(live[back].seq, static_cast<std::int64_t>(kBack) + 1) << "the gap shows in the numbers";
  EXPECT_EQ(live.back().state_text, "TRACKING") << service.log();
  ASSERT_FALSE(service.health.messages.empty());
  EXPECT_EQ(service.health.messages.back().dropped_in_source, static_cast<std::int64_t>(kBack - kLost));
  // Each spell told was counted, once; a loaded machine may add spells of its own.
  EXPECT_EQ(service.health.messages.back().camera_timeouts, spells_of(live, "CAMERA_FAULT", "no pictures"));
}

// A step in recorded time is played as what it says: nothing for as long. Longer than a device may be silent.
TEST_F(EndToEnd, AStepInRecordedTimeIsSilenceAndThenGoesOn) {
  const TemporaryFolder folder;
  const auto dive = test::copied_dive(folder);
  for (int camera = 0; camera < 2; ++camera) {
    const auto list = dive / "mav0" / ("cam" + std::to_string(camera)) / "data.csv";
    std::istringstream lines(test::read_text(list));
    std::string line, shifted;
    for (int i = -1; std::getline(lines, line); ++i) {
      const std::size_t comma = line.find(',');
      if (i >= 12) line = std::to_string(std::stoll(line.substr(0, comma)) + 2'000'000'000) + line.substr(comma);
      shifted += line + "\n";
    }
    test::write_text(list, shifted);
  }
  RunningService service(dive, kPatient, 4);
  ASSERT_EQ(service.finish(), 0) << service.log();
  EXPECT_LT(first_of(service.odom.messages, "CAMERA_FAULT", "no pictures"), 12U + 5U) << service.log();
  EXPECT_EQ(service.odom.messages.back().seq, test::kDiveFrames + 2 * std::lround(test::kDiveRate_hz)) << "played once";
  EXPECT_TRUE(service.odom.messages.back().pose_valid) << service.log();
}

TEST_F(EndToEnd, AProcessStoppedFor300msSaysItWasLateAndRecovers) {
  RunningService service(test::rendered_dive(), "timing:\n  latency_ms: 150\n  deadline_tolerance_ms: 50\n# repeat\n",
                         5);
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  service.process->send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  service.odom.wait([] { return false; }, 0.05);
  const std::size_t before = service.odom.messages.size();
  service.process->send(SIGCONT);
  ASSERT_TRUE(service.odom.wait_for(before + 5)) << service.log();
  const auto told = std::find_if(service.odom.messages.begin() + static_cast<std::ptrdiff_t>(before),
                                 service.odom.messages.begin() + static_cast<std::ptrdiff_t>(before) + 5,
                                 [](const vis_odom_t& m) { return m.deadline_missed || m.state_text != "TRACKING"; });
  EXPECT_NE(told, service.odom.messages.begin() + static_cast<std::ptrdiff_t>(before) + 5) << service.log();
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait(), 0);
}

TEST_F(EndToEnd, SigtermEndsItCleanlyWithinASecond) {
  RunningService service(test::rendered_dive(), kForever, 7);
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  service.process->send(SIGHUP);
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait_at_most(1.0), 0) << service.log();
  EXPECT_NE(service.log().find("stopped after"), std::string::npos) << service.log();
}

}  // namespace
}  // namespace pelorus
