#include "services/capture.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace pelorus {
namespace {

using namespace std::chrono_literals;

// What a device does is said by the test, from outside.
struct Device {
  std::atomic<bool> present{true};
  std::atomic<bool> delivers{true};
  std::atomic<bool> spoils{false};
  std::atomic<int> frames_left{1'000'000};
  std::atomic<double> rate_hz{0};
  std::atomic<bool> single{false};  // one frame although it does not deliver
};

class ScriptedCamera final : public Camera {
 public:
  explicit ScriptedCamera(Device& device) : device_(device) {}
  Result<> open() override {
    if (!device_.present) return Error{ErrorCode::device, "camera", "is not there", "plug it in"};
    opened_.add();
    return Ok{};
  }
  Result<> start() override { return Ok{}; }
  FrameOutcome next(CameraFrame& frame, Duration timeout) override {
    if (device_.frames_left == 0) return FrameOutcome::ended;
    if (!device_.present) return FrameOutcome::lost;
    std::this_thread::sleep_for(device_.delivers ? Duration(1ms) : std::min<Duration>(timeout, 5ms));
    if (!device_.delivers && !device_.single.exchange(false)) return FrameOutcome::timeout;
    if (device_.spoils) return FrameOutcome::dropped;
    --device_.frames_left;
    frames_.add();
    frame.seq = frames_.value();
    frame.mid_exposure.ns = static_cast<std::int64_t>(frame.seq);
    return FrameOutcome::frame;
  }
  void stop() override {}
  FrameFormat format() const override { return {8, 4, 1}; }
  CameraStatistics statistics() const override {
    CameraStatistics s;
    s.frames = frames_.value();
    s.opened = opened_.value();
    return s;
  }
  double rate_hz() const override { return device_.rate_hz; }
  std::string description() const override { return "scripted"; }

 private:
  Device& device_;
  Counter frames_;
  Counter opened_;
};

class CaptureTest : public testing::Test {
 protected:
  bool reaches(CaptureState state) {
    for (int i = 0; i < 2000; ++i) {
      if (capture_.status().state == state) return true;
      std::this_thread::sleep_for(5ms);
    }
    return false;
  }

  Device device_;
  FrameRing ring_{4, {8, 4, 1}};
  Capture capture_{std::make_unique<ScriptedCamera>(device_),
                   ring_,
                   {.silent_after_s = 0.1, .reopen_after_s = 0.3, .retry_first_s = 0.02, .retry_longest_s = 0.05}};
};

TEST_F(CaptureTest, HandsFramesToTheRing) {
  std::uint64_t last = 0;
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(ring_.wait(10s));
    const FrameLease frame = ring_.newest();
    EXPECT_GT(frame->seq, last);
    last = frame->seq;
  }
  EXPECT_TRUE(reaches(CaptureState::streaming));
  EXPECT_EQ(capture_.status().description, "scripted");
  EXPECT_GE(capture_.status().last_frame.ns, static_cast<std::int64_t>(last));
}

TEST_F(CaptureTest, TakesUpACameraThatCameBack) {
  ASSERT_TRUE(reaches(CaptureState::streaming));
  device_.present = false;
  ASSERT_TRUE(reaches(CaptureState::lost));
  std::this_thread::sleep_for(50ms);
  EXPECT_NE(capture_.status().last_problem.find("plug it in"), std::string::npos);
  device_.present = true;
  EXPECT_TRUE(reaches(CaptureState::streaming));
  EXPECT_EQ(capture_.status().camera.opened, 2U);
}

TEST_F(CaptureTest, OpensASilentCameraAnew) {
  ASSERT_TRUE(reaches(CaptureState::streaming));
  device_.delivers = false;
  EXPECT_TRUE(reaches(CaptureState::silent));
  EXPECT_TRUE(reaches(CaptureState::lost));
  device_.delivers = true;
  EXPECT_TRUE(reaches(CaptureState::streaming));
  EXPECT_GE(capture_.status().camera.opened, 2U);
}

TEST_F(CaptureTest, SpoiltFramesAreSilenceButNoReasonToOpenAnew) {
  ASSERT_TRUE(reaches(CaptureState::streaming));
  device_.spoils = true;
  EXPECT_TRUE(reaches(CaptureState::silent));
  std::this_thread::sleep_for(500ms);  // longer than reopen_after_s
  EXPECT_EQ(capture_.status().state, CaptureState::silent);
  device_.spoils = false;
  EXPECT_TRUE(reaches(CaptureState::streaming));
  EXPECT_EQ(capture_.status().camera.opened, 1U);
}

TEST_F(CaptureTest, ASlowCameraIsNotOpenedAnewBeforeItsNextFramesAreDue) {
  device_.rate_hz = 1;
  device_.delivers = false;
  EXPECT_TRUE(reaches(CaptureState::silent));
  std::this_thread::sleep_for(900ms);  // three times reopen_after_s, less than a period
  device_.delivers = true;
  EXPECT_TRUE(reaches(CaptureState::streaming));
  EXPECT_EQ(capture_.status().camera.opened, 1U);
}

TEST(Capture, ACameraOfUnknownRateIsJudgedByTheOneItHas) {
  Device device;
  device.delivers = false;
  FrameRing ring(4, {8, 4, 1});
  const Capture capture(std::make_unique<ScriptedCamera>(device), ring, {.reopen_after_s = 1.0});
  const auto deliver_one = [&] {
    const std::uint64_t before = capture.status().camera.frames;
    device.single = true;
    for (int i = 0; i < 2000 && capture.status().camera.frames == before; ++i) std::this_thread::sleep_for(1ms);
  };
  // Every 0.3 s, and then none for longer than reopen_after_s.
  for (int i = 0; i < 5; ++i) {
    deliver_one();
    std::this_thread::sleep_for(300ms);
  }
  ASSERT_EQ(capture.status().camera.opened, 1U);
  std::this_thread::sleep_for(1s);
  deliver_one();
  EXPECT_EQ(capture.status().camera.opened, 1U);
}

TEST(ReopenLimit, IsSixPeriodsOfASlowCameraAndTheLeastOfAFastOne) {
  EXPECT_EQ(reopen_limit(1.5, 20, 50ms), 1500ms);
  EXPECT_EQ(reopen_limit(1.5, 0, Duration::zero()), 1500ms);
  EXPECT_EQ(reopen_limit(1.5, 0.5, Duration::zero()), 12s) << "as it states";
  EXPECT_EQ(reopen_limit(1.5, 0, 2s), 12s) << "as it does";
  EXPECT_EQ(reopen_limit(1.5, 5, 1s), 6s) << "slower than it states, as automatic exposure makes it in the dark";
  EXPECT_EQ(reopen_limit(30, 1, 1s), 30s);
}

TEST_F(CaptureTest, EndsWithRecordedFrames) {
  device_.frames_left = 3;
  EXPECT_TRUE(reaches(CaptureState::ended));
}

TEST(Capture, AnAbsentCameraDoesNotDelayTheStop) {
  Device device;
  device.present = false;
  FrameRing ring(3, {8, 4, 1});
  const auto begin = std::chrono::steady_clock::now();
  {
    const Capture capture(std::make_unique<ScriptedCamera>(device), ring,
                          {.retry_first_s = 600, .retry_longest_s = 600});
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 60s);
}

}  // namespace
}  // namespace pelorus
