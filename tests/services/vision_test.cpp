// The vision thread between a real frame ring and a real result ring, fed with a rendered dive.
#include "services/vision.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "services/publish_thread.h"
#include "tests/drivers/synthetic/small_dive.h"

namespace pelorus {
namespace {

synthetic::Scene textured_dive() {
  synthetic::Scene scene = synthetic::small_dive();
  scene.sensor.read_noise_grey = 1.0;  // real pictures never repeat
  return scene;
}

class VisionBench : public ::testing::Test {
 protected:
  VisionBench() : rectifier_(Rectifier::create(source_.calibration(), "scene").value()) {
    watch_.frame_timeout_ms = 60'000;  // a loaded machine shall not make a camera fault of a pause
  }

  void start() {
    vision_ = std::make_unique<Vision>(VisionParts{sync_, rectifier_, desk_.results, control_, clock_},
                                       PipelineConfig{}, watch_, TimingConfig{});
  }
  // The next pair of the dive, or `frame` of it again, through the ring and vision.
  Publication pass(int frame) { return pass(frame, clock_.now()); }
  Publication pass(int frame, Timestamp taken) {
    source_.render(frame, pair_);
    CameraFrame& slot = ring_.slot();
    slot.resize({pair_.left.width(), pair_.left.height(), 2});
    slot.view[0].assign(pair_.left.view());
    slot.view[1].assign(pair_.right.view());
    slot.seq = ++camera_seq_;
    slot.mid_exposure = slot.arrival = taken;
    slot.time_source = time_source_;
    ring_.publish();
    return result();
  }
  Publication result() {
    for (int i = 0; i < 2000; ++i) {
      if (const Publication* front = desk_.results.front()) {
        Publication copy = *front;
        desk_.results.release();
        return copy;
      }
      desk_.wake.wait(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "no result";
    return {};
  }

  CaptureClock clock_;
  synthetic::SyntheticSource source_{textured_dive()};
  Rectifier rectifier_;
  SourcePair pair_;
  FrameRing ring_{6, {320, 240, 2}};
  StereoSync sync_{ring_};
  PublishDesk desk_;
  VisionControl control_;
  CaptureWatchConfig watch_;
  std::uint64_t camera_seq_ = 0;
  TimeSource time_source_ = TimeSource::hardware;
  std::unique_ptr<Vision> vision_;
};

TEST_F(VisionBench, EveryPairBecomesOneResultDueAtTheDeclaredLatency) {
  start();
  for (int frame = 0; frame < 5; ++frame) {
    const Publication p = pass(frame);
    EXPECT_EQ(p.result.seq, static_cast<std::uint64_t>(frame) + 1);
    EXPECT_EQ(p.release_due - p.result.capture_time, std::chrono::milliseconds(100));
    EXPECT_TRUE(p.result.pose_valid) << to_text(p.result.state);
    EXPECT_EQ(p.step > Duration::zero(), frame > 0);
  }
  EXPECT_EQ(vision_->status().pairs, 5U);
}

TEST_F(VisionBench, FrozenPicturesAreACameraFaultWithinFourPairsAndEndWithTheNextLiveOne) {
  start();
  pass(0), pass(1);
  EXPECT_EQ(pass(1).reason, StateReason::repeated_picture);
  EXPECT_FALSE(pass(1).result.pose_valid);
  const Publication frozen = pass(1);
  EXPECT_EQ(frozen.result.state, VisionState::camera_fault);
  EXPECT_EQ(frozen.reason, StateReason::frozen_pictures);
  EXPECT_TRUE(pass(2).result.pose_valid);
  EXPECT_EQ(vision_->status().frozen_spells, 1U);
}

TEST_F(VisionBench, SilenceIsSpokenOfAndEndsWithTheNextPair) {
  watch_.frame_timeout_ms = 50;
  start();
  const Publication missing = result();
  EXPECT_EQ(missing.result.state, VisionState::camera_fault);
  EXPECT_FALSE(missing.has_picture);
  Publication seen = pass(0);
  while (!seen.has_picture) seen = result();
  EXPECT_EQ(seen.result.state, VisionState::init);
  EXPECT_EQ(vision_->status().missing_spells, 1U);
}

// Stamped 0.3 s apart: the silence is longer than the half second of a rate that is not known.
TEST_F(VisionBench, SilenceIsToldAfterThreePeriodsOfTheRateThatWasSeen) {
  watch_.frame_timeout_ms = 0;
  start();
  Timestamp last;
  const Timestamp first = clock_.now();
  for (int frame = 0; frame < 6; ++frame) {
    last = clock_.now();
    Publication seen = pass(frame, first + frame * std::chrono::milliseconds(300));
    while (!seen.has_picture) seen = result();
  }
  const Publication missing = result();
  EXPECT_EQ(missing.reason, StateReason::no_pictures);
  EXPECT_GE(1e3 * seconds(missing.result.capture_time - last), 3 * 300);
}

TEST_F(VisionBench, PairsMissingInTheCountDegradeOneResult) {
  start();
  pass(0), pass(1);
  camera_seq_ += 2;
  const Publication after = pass(2);
  EXPECT_EQ(after.result.seq, 5U);
  EXPECT_EQ(after.pairs_dropped, 2U);
  EXPECT_EQ(after.reason, StateReason::pairs_dropped);
  EXPECT_EQ(vision_->status().pairs_missed, 2U);
}

TEST_F(VisionBench, ACameraThatCountsAnewLosesNothing) {
  start();
  pass(0), pass(1);
  camera_seq_ = 0;
  const Publication after = pass(2);
  EXPECT_EQ(after.result.seq, 3U);
  EXPECT_EQ(after.pairs_dropped, 0U);
}

TEST_F(VisionBench, AStampThatTheDriverReplacedDegradesItsPair) {
  start();
  time_source_ = TimeSource::hardware;
  pass(0), pass(1);
  time_source_ = TimeSource::arrival;
  const Publication replaced = pass(2);
  EXPECT_EQ(replaced.reason, StateReason::time_jump);
  EXPECT_TRUE(replaced.result.pose_valid);
  time_source_ = TimeSource::hardware;
  EXPECT_NE(pass(3).reason, StateReason::time_jump);
}

TEST_F(VisionBench, ACameraWithoutStampsIsNotBlamedForIt) {
  start();
  time_source_ = TimeSource::arrival;
  pass(0);
  EXPECT_NE(pass(1).reason, StateReason::time_jump);
}

TEST_F(VisionBench, StandbyRestsAndAResetStartsTheWorldAnew) {
  start();
  pass(0), pass(1), pass(2);
  control_.standby = true;
  EXPECT_EQ(pass(3).result.state, VisionState::standby);
  control_.standby = false;
  const int resets = pass(4).result.reset_counter;
  control_.resets = 1;
  // A pair may already be under way when the request comes.
  Publication p = pass(5);
  if (p.result.state != VisionState::init) p = pass(6);
  EXPECT_EQ(p.result.state, VisionState::init);
  EXPECT_EQ(p.result.reset_counter, resets + 1);
  EXPECT_TRUE(p.result.T_world_cam.isApprox(Rigid3::Identity()));
}

TEST_F(VisionBench, PicturesOfAnotherSizeAreACalibrationFault) {
  start();
  pass(0);
  CameraFrame& slot = ring_.slot();
  slot.resize({160, 120, 2});
  slot.seq = ++camera_seq_;
  slot.mid_exposure = slot.arrival = clock_.now();
  ring_.publish();
  EXPECT_EQ(result().result.state, VisionState::calibration_fault);
}

}  // namespace
}  // namespace pelorus
