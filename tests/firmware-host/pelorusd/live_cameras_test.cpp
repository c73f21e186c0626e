// The whole service on two real GigE Vision cameras made of software (Aravis' fake camera over loopback): pelorusd as a
// process of its own, a listener on LCM. The cameras show a rendered dive, there and back again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "drivers/synthetic/synthetic_source.h"
#include "firmware-host/runtime/calibration_writer.h"
#include "tests/firmware-host/pelorusd/running_service.h"
#include "tests/support/fake_gv_camera.h"
#include "tests/support/private_network.h"

namespace pelorus {
namespace {

constexpr std::int64_t kPeriod_ns = 100'000'000;
const char* const kAddress[2] = {"127.0.1.2", "127.0.1.3"};

// One network for the whole program: a process can enter one, and only while it has no threads.
bool in_private_network() {
  static const bool entered = test::enter_private_network({kAddress[0], kAddress[1]}) && test::add_multicast_route();
  return entered;
}

// Pictures of the dive, rendered once.
struct RenderedDive {
  RenderedDive() {
    std::string text = test::read_text(PELORUS_SOURCE_DIR "/tests/golden/small_dive.yaml");
    text.replace(text.find("frames: 16"), 10, "frames: " + std::to_string(test::kDiveFrames));
    test::write_text(folder.path() / "scene.yaml", text);
    synthetic::SyntheticSource rendering(synthetic::load_scene(folder.path() / "scene.yaml").value());
    for (int i = 0; i < test::kDiveFrames; ++i) {
      SourcePair pair;
      rendering.render(i, pair);
      T_world_cam.push_back(rendering.T_world_cam(i));
      picture[0].push_back(std::move(pair.left));
      picture[1].push_back(std::move(pair.right));
    }
    StereoCalibration cameras_only = rendering.calibration();
    cameras_only.body_known = false;  // as most calibrations are
    EXPECT_TRUE(write_calibration(cameras_only, CalibrationFormat::kalibr, folder.path() / "rig.yaml").ok());
  }
  // There and back: no jump in the motion, no picture twice in a row.
  static std::size_t frame_at(std::int64_t time_ns) {
    constexpr std::int64_t kLast = test::kDiveFrames - 1;
    const std::int64_t step = (time_ns + kPeriod_ns / 2) / kPeriod_ns % (2 * kLast);
    return static_cast<std::size_t>(step <= kLast ? step : 2 * kLast - step);
  }
  test::TemporaryFolder folder;
  std::vector<Image> picture[2];
  std::vector<Rigid3> T_world_cam;
};

class LiveCameras : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!in_private_network()) GTEST_SKIP() << "no private network: unshare() is not permitted";
    switch_on(0);
    switch_on(1);
  }
  static const RenderedDive& dive() {
    static const RenderedDive rendered;
    return rendered;
  }
  void switch_on(int side) {
    const std::vector<Image>& pictures = dive().picture[side];
    cameras_[side].emplace(kAddress[side], "P" + std::to_string(side), pictures[0].width(), pictures[0].height(),
                           [&pictures](std::uint8_t* pixels, int width, int height, std::int64_t time_ns) {
                             const Image& image = pictures[RenderedDive::frame_at(time_ns)];
                             for (int v = 0; v < height; ++v) std::copy_n(image.row(v), width, pixels + v * width);
                           });
    ASSERT_TRUE(cameras_[side]->running());
  }
  void start(int bus) {
    begin(bus, kAddress[0], kAddress[1]);
    ASSERT_TRUE(service_->wait_for_state("TRACKING")) << service_->log();
  }
  void begin(int bus, const std::string& left, const std::string& right) {
    const std::string source =
        "source:\n  kind: aravis\n  calibration: " + (dive().folder.path() / "rig.yaml").string() +
        "\ncamera:\n  left: " + left + "\n  right: " + right + "\n  rate_hz: 10\n  clock: ptp\n  tolerance_ms: 40\n";
    service_.emplace(source, "timing:\n  latency_ms: 400\n  deadline_tolerance_ms: 1000\n", bus);
  }
  static std::int64_t now_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
  }
  // Until a message of that state and reason; how many pairs after `since_us` its pair was taken.
  double periods_until(const std::string& state, const std::string& reason, std::int64_t since_us) {
    EXPECT_TRUE(service_->wait_for_state(state, reason)) << state << "\n" << service_->log();
    return static_cast<double>(service_->odom.messages.back().utime - since_us) * 1e3 / kPeriod_ns;
  }
  void finish() {
    service_->process->send(SIGTERM);
    EXPECT_EQ(service_->process->wait_at_most(1), 0) << "-2: still running after a second\n" << service_->log();
  }

  std::optional<test::FakeGvCamera> cameras_[2];
  std::optional<test::RunningService> service_;
};

TEST_F(LiveCameras, PairsBecomeResultsThatFollowTheTruth) {
  start(11);
  const std::size_t first = service_->odom.messages.size();
  ASSERT_TRUE(service_->odom.wait_for(first + 40, 30)) << service_->log();
  const auto& all = service_->odom.messages;
  int compared = 0;
  for (std::size_t i = first; i < all.size(); ++i) {
    if (all[i].step_s < 0.05 || all[i].step_s > 0.15) continue;  // a pair the loaded machine lost
    const auto frame = [](const vis_odom_t& m) { return RenderedDive::frame_at(m.utime * 1000); };
    const Rigid3 T_prev_curr = dive().T_world_cam[frame(all[i - 1])].inverse() * dive().T_world_cam[frame(all[i])];
    // Without a known body the camera looks ahead: x of the body is the optical axis.
    const Eigen::Vector3d& t = T_prev_curr.translation();
    const Eigen::Vector3d expected(t.z(), t.x(), t.y());
    EXPECT_LT((Eigen::Vector3d(all[i].step_pos_m) - expected).norm(), 0.005) << "pair " << all[i].seq;
    ++compared;
  }
  EXPECT_GT(compared, 20);
  finish();
  service_->health.wait([] { return false; }, 0.2);
  ASSERT_FALSE(service_->health.messages.empty());
  const vis_health_t& health = service_->health.messages.back();
  EXPECT_GE(health.pairs_captured, health.results_published - health.camera_timeouts * 20);
  EXPECT_EQ(health.dropped_ring_full + health.results_dropped, 0);
}

TEST_F(LiveCameras, ALeftCameraThatIsLostIsAFaultWithinFivePairsAndItsReturnEndsIt) {
  start(12);
  const std::int64_t lost_us = now_us();
  cameras_[0].reset();
  EXPECT_LE(periods_until("CAMERA_FAULT", "no pictures", lost_us), 5) << service_->log();
  EXPECT_FALSE(service_->odom.messages.back().pose_valid);
  switch_on(0);
  EXPECT_TRUE(service_->wait_for_state("TRACKING")) << service_->log();
  finish();
}

TEST_F(LiveCameras, ExchangedOnesGiveNoPoseAndStateAndLogSayWhy) {
  begin(16, kAddress[1], kAddress[0]);
  ASSERT_TRUE(service_->wait_for_state("LOST", "few points")) << service_->log();
  const auto told = [&] { return service_->log().find("pictures are exchanged") != std::string::npos; };
  EXPECT_TRUE(service_->odom.wait(told, 20)) << service_->log();
  EXPECT_TRUE(service_->wait_for_state("CALIBRATION_FAULT", "left and right pictures exchanged")) << service_->log();
  const auto in_health = [&] {
    return std::any_of(service_->health.messages.begin(), service_->health.messages.end(),
                       [](const vis_health_t& m) { return m.reason_text == "left and right pictures exchanged"; });
  };
  EXPECT_TRUE(service_->health.wait(in_health, 5)) << service_->log();
  // The first pair is the origin, whatever it shows.
  for (const vis_odom_t& m : service_->odom.messages) {
    EXPECT_TRUE(!m.pose_valid || m.state_text == "INIT") << m.seq << " " << m.state_text;
  }
  finish();
}

// While it searches for the camera, and while it does not know yet that the camera is gone.
TEST_F(LiveCameras, ACameraThatIsLostDoesNotHoldUpTheStop) {
  start(14);
  cameras_[0].reset();
  EXPECT_TRUE(service_->wait_for_state("CAMERA_FAULT", "no pictures")) << service_->log();
  finish();
  EXPECT_NE(service_->log().find("stopped after"), std::string::npos) << service_->log();
  switch_on(0);
  start(15);
  cameras_[0].reset();
  cameras_[1].reset();
  finish();
  EXPECT_NE(service_->log().find("stopped after"), std::string::npos) << service_->log();
}

TEST_F(LiveCameras, AClockThatJumpsDegradesWithinFivePairsAndRecovers) {
  start(13);
  const std::int64_t jumped_us = now_us();
  for (auto& camera : cameras_) camera->set_clock_offset(5'000'000'000);
  EXPECT_LE(periods_until("DEGRADED", "time stamps jumped", jumped_us), 5) << service_->log();
  const std::int64_t utime = service_->odom.messages.back().utime;
  EXPECT_LT(utime, service_->odom.messages.back().publish_utime) << "the published time did not jump";
  EXPECT_TRUE(service_->wait_for_state("TRACKING")) << service_->log();
  ASSERT_TRUE(service_->health.wait(
      [&] { return !service_->health.messages.empty() && service_->health.messages.back().time_jumps >= 2; }));
  finish();
}

}  // namespace
}  // namespace pelorus
