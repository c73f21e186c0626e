// Against Aravis' own fake camera: the real protocols, over the loopback of a network of this process.

#include "drivers/aravis/aravis_camera.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>

#include "drivers/aravis/aravis_discovery.h"
#include "drivers/aravis/aravis_settings.h"
#include "tests/support/fake_gv_camera.h"
#include "tests/support/private_network.h"

namespace pelorus {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 320;
constexpr int kHeight = 240;
const char* const kAddress = "127.0.1.2";

// Every pixel depends on its place and on the frame's number, which is in the first two.
class AravisCameraTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::enter_private_network({kAddress})) GTEST_SKIP() << "no private network: unshare() is not permitted";
    switch_on();
  }
  void switch_on() {
    device_.emplace(kAddress, "T1", kWidth, kHeight, [this](std::uint8_t* pixels, int width, int height, std::int64_t) {
      const unsigned number = ++painted_;
      for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u) pixels[v * width + u] = pixel(u, v, number);
      pixels[0] = static_cast<std::uint8_t>(number & 0xFF);
      pixels[1] = static_cast<std::uint8_t>(number >> 8);
    });
    ASSERT_TRUE(device_->running());
  }
  static std::uint8_t pixel(int u, int v, unsigned number) {
    return static_cast<std::uint8_t>(static_cast<unsigned>(u ^ v) + number);
  }
  static AravisConfig config() {
    AravisConfig c;
    c.device = kAddress;
    c.rate_hz = 50;
    c.exposure_us = 4000;
    return c;
  }
  static void open(AravisCamera& camera) {
    const Result<> opened = camera.open();
    ASSERT_TRUE(opened.ok()) << opened.error().message();
    const Result<> started = camera.start();
    ASSERT_TRUE(started.ok()) << started.error().message();
  }
  // The next frame, whatever else comes before it.
  static bool receive(AravisCamera& camera, CameraFrame& frame, Duration limit = 10s) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < end)
      if (camera.next(frame, 100ms) == FrameOutcome::frame) return true;
    return false;
  }
  static unsigned number_of(const CameraFrame& frame) {
    return frame.view[0].row(0)[0] + 256U * frame.view[0].row(0)[1];
  }

  CaptureClock clock_;
  std::optional<test::FakeGvCamera> device_;
  unsigned painted_ = 0;
};

TEST_F(AravisCameraTest, DeliversWholePicturesInOrderWithGrowingTime) {
  for (const bool packet_socket : {true, false}) {
    AravisConfig c = config();
    c.packet_socket = packet_socket;
    AravisCamera camera(c, clock_);
    open(camera);
    EXPECT_EQ(camera.format().width, kWidth);
    EXPECT_EQ(camera.format().height, kHeight);
    CameraFrame frame;
    std::uint64_t last_seq = 0;
    unsigned last_number = 0;
    Timestamp last;
    for (int i = 0; i < 200; ++i) {  // beyond the wrap of the fake camera's ids
      ASSERT_TRUE(receive(camera, frame));
      for (int v = 1; v < kHeight; v += 7)
        for (int u = 0; u < kWidth; ++u) ASSERT_EQ(frame.view[0].row(v)[u], pixel(u, v, number_of(frame)));
      if (i > 0) {
        // The count of exposures grows exactly as the camera's own.
        ASSERT_EQ(frame.seq - last_seq, number_of(frame) - last_number);
        ASSERT_GT(frame.mid_exposure, last);
      }
      last_seq = frame.seq;
      last_number = number_of(frame);
      last = frame.mid_exposure;
    }
    EXPECT_EQ(camera.statistics().frames, 200U);
    EXPECT_EQ(camera.statistics().incomplete + camera.statistics().underruns, 0U);
    camera.stop();
  }
}

TEST_F(AravisCameraTest, StampsTheMiddleOfTheExposureOnTheCaptureClock) {
  for (const std::int64_t offset_ns :
       {std::int64_t{0}, std::int64_t{37'000'000'000}, std::int64_t{-5'000'000'000'000}}) {
    device_->set_clock_offset(offset_ns);
    AravisConfig c = config();
    c.clock = DeviceClockKind::ptp;
    AravisCamera camera(c, clock_);
    open(camera);
    CameraFrame frame;
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(receive(camera, frame));
    EXPECT_EQ(frame.exposure, 4ms);
    EXPECT_EQ(frame.time_source, TimeSource::hardware);
    // Exposed before it arrived and not long ago; half the exposure of 4 ms is added to the stamp of its start.
    EXPECT_GT(frame.arrival - frame.mid_exposure, -3ms);
    EXPECT_LT(frame.arrival - frame.mid_exposure, 1s);
    if (offset_ns >= 0) {
      // Fired at a multiple of its period, stamped within the scheduling delay after it.
      const std::int64_t after_ns = (frame.mid_exposure.ns - 2'000'000) % 20'000'000;
      EXPECT_LT(after_ns, 15'000'000);
    }
  }
}

TEST_F(AravisCameraTest, LostPacketsSpoilFramesAndAreCounted) {
  AravisConfig c = config();
  c.resend = false;
  AravisCamera camera(c, clock_);
  open(camera);
  CameraFrame frame;
  ASSERT_TRUE(receive(camera, frame));
  device_->lose_packets(0.01);  // 55 packets a frame: 42 % of the frames
  int dropped = 0;
  int whole = 0;
  for (int i = 0; i < 1000 && dropped + whole < 60; ++i) {
    const FrameOutcome outcome = camera.next(frame, 100ms);
    dropped += outcome == FrameOutcome::dropped ? 1 : 0;
    if (outcome != FrameOutcome::frame) continue;
    ++whole;
    for (int v = 1; v < kHeight; v += 7)
      for (int u = 0; u < kWidth; ++u) ASSERT_EQ(frame.view[0].row(v)[u], pixel(u, v, number_of(frame)));
  }
  EXPECT_GT(dropped, 5);
  EXPECT_GT(whole, 5);
  EXPECT_EQ(camera.statistics().incomplete, static_cast<std::uint64_t>(dropped));
  EXPECT_GT(camera.statistics().missing_packets, 0U);
  device_->lose_packets(0);
  const std::uint64_t before = camera.statistics().incomplete;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(receive(camera, frame));
  EXPECT_LE(camera.statistics().incomplete - before, 1U);  // the one that was under way
}

TEST_F(AravisCameraTest, AsksForLostPacketsAgain) {
  AravisCamera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  ASSERT_TRUE(receive(camera, frame));
  device_->lose_packets(0.02);
  for (int i = 0; i < 200 && camera.statistics().resend_requests == 0; ++i)
    static_cast<void>(camera.next(frame, 100ms));
  EXPECT_GT(camera.statistics().resend_requests, 0U);
}

TEST_F(AravisCameraTest, AJumpOfTheCamerasClockIsCounted) {
  AravisCamera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(receive(camera, frame));
  device_->set_clock_offset(3'600'000'000'000);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(receive(camera, frame));
    EXPECT_LT(frame.mid_exposure - clock_.now(), 100ms);
  }
  EXPECT_EQ(camera.statistics().time_corrections, 1U);
}

TEST_F(AravisCameraTest, ComesBackAfterTheCameraWasOff) {
  AravisCamera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  ASSERT_TRUE(receive(camera, frame));
  const std::uint64_t last_seq = frame.seq;
  device_.reset();
  while (camera.next(frame, 1200ms) == FrameOutcome::frame) {
  }
  const auto before = std::chrono::steady_clock::now();
  camera.stop();
  EXPECT_FALSE(camera.open().ok());
  EXPECT_LT(std::chrono::steady_clock::now() - before, 2s);  // Aravis alone would take 12 s
  switch_on();
  open(camera);
  ASSERT_TRUE(receive(camera, frame));
  EXPECT_GT(frame.seq, last_seq);
  EXPECT_EQ(camera.statistics().opened, 2U);
}

TEST_F(AravisCameraTest, LostControlIsTold) {
  AravisCamera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  ASSERT_TRUE(receive(camera, frame));
  device_.reset();
  bool told = false;
  for (int i = 0; i < 150 && !told; ++i) told = camera.next(frame, 100ms) == FrameOutcome::lost;  // about 6 s
  EXPECT_TRUE(told);
  EXPECT_EQ(camera.statistics().lost, 1U);
}

TEST_F(AravisCameraTest, AnImpossibleSettingNamesTheCameraAndTheSetting) {
  AravisConfig c = config();
  c.pixel_format = "Mono9";
  AravisCamera camera(c, clock_);
  const Result<> opened = camera.open();
  ASSERT_FALSE(opened.ok());
  EXPECT_NE(opened.error().message().find(kAddress), std::string::npos);
  EXPECT_NE(opened.error().message().find("Mono9"), std::string::npos);
}

TEST_F(AravisCameraTest, ATriggerIsSetAndTakenBack) {
  const GObjectPtr<ArvCamera> camera(arv_camera_new(kAddress, nullptr));
  ASSERT_TRUE(camera);
  AravisConfig c = config();
  c.trigger = "Line0";
  ASSERT_TRUE(apply_aravis_settings(camera.get(), c).ok());
  EXPECT_STREQ(arv_camera_get_trigger_source(camera.get(), nullptr), "Line0");
  EXPECT_STREQ(arv_camera_get_string(camera.get(), "TriggerMode", nullptr), "On");
  c.trigger.clear();
  ASSERT_TRUE(apply_aravis_settings(camera.get(), c).ok());
  EXPECT_STREQ(arv_camera_get_string(camera.get(), "TriggerMode", nullptr), "Off");
  c.trigger = "Line7";
  const Result<> refused = apply_aravis_settings(camera.get(), c);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message().find("a trigger at Line7"), std::string::npos) << refused.error().message();
}

TEST_F(AravisCameraTest, WithoutATriggerACameraThatWaitsForOneIsSilent) {
  AravisConfig c = config();
  c.trigger = "Software";
  AravisCamera camera(c, clock_);
  open(camera);
  CameraFrame frame;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.next(frame, 100ms), FrameOutcome::timeout);
  EXPECT_EQ(camera.statistics().frames, 0U);
}

TEST_F(AravisCameraTest, IsFoundOnTheNetwork) {
  const std::vector<FoundCamera> found = find_aravis_cameras();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].address, kAddress);
  EXPECT_EQ(found[0].serial, "T1");
}

}  // namespace
}  // namespace pelorus
