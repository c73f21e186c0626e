// Against the kernel's virtual camera driver, vivid, in a virtual machine (tests/hil/guest.sh); without it only what
// happens without a device.

#include "drivers/v4l2/v4l2_camera.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>

#include "drivers/v4l2/v4l2_discovery.h"

namespace pelorus {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 320;
constexpr int kHeight = 180;

std::string problem_of(const std::string& path) {
  const CaptureClock clock;
  V4l2Config config;
  config.device = path;
  V4l2Camera camera(config, clock);
  const Result<> opened = camera.open();
  return opened ? "none" : opened.error().message();
}

TEST(V4l2Camera, AnAbsentDeviceIsNamed) {
  EXPECT_NE(problem_of("/dev/video-none").find("/dev/video-none"), std::string::npos);
  EXPECT_NE(problem_of("/dev/video-none").find("cannot be opened"), std::string::npos);
}

TEST(V4l2Camera, ADeviceOfAnotherKindIsRefused) {
  EXPECT_NE(problem_of("/dev/null").find("is no V4L2 device"), std::string::npos);
}

TEST(V4l2Camera, NextWithoutAStreamIsLost) {
  const CaptureClock clock;
  V4l2Camera camera({}, clock);
  CameraFrame frame;
  EXPECT_EQ(camera.next(frame, 0ms), FrameOutcome::lost);
}

class VividTest : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    V4l2Device device;
    if (!device.open("/dev/video0") || device.name().find("vivid") == std::string::npos)
      GTEST_SKIP() << "no vivid at /dev/video0: run tests/hil/v4l2.sh";
    set("timestamp_source", 1);  // start of exposure; at the end of frame vivid stamps the future
  }
  static void set(const std::string& control, int value, int device = 0) {
    const std::string command =
        "v4l2-ctl -d /dev/video" + std::to_string(device) + " -c " + control + "=" + std::to_string(value);
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
  static V4l2Config config(const std::string& pixels = "GREY", int device = 0) {
    V4l2Config c;
    c.device = "/dev/video" + std::to_string(device);
    c.pixel_format = pixels;
    c.width_px = kWidth;
    c.height_px = kHeight;
    c.rate_hz = 25;
    return c;
  }
  static void open(V4l2Camera& camera) {
    const Result<> opened = camera.open();
    ASSERT_TRUE(opened.ok()) << opened.error().message();
    const Result<> started = camera.start();
    ASSERT_TRUE(started.ok()) << started.error().message();
  }
  static bool receive(V4l2Camera& camera, CameraFrame& frame, Duration limit = 20s) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < end)
      if (camera.next(frame, 200ms) == FrameOutcome::frame) return true;
    return false;
  }
  // The test card has bright and dark fields.
  static int contrast(const Image& image) {
    int least = 255;
    int most = 0;
    for (int v = 0; v < image.height(); ++v)
      for (int u = 0; u < image.width(); ++u) {
        least = std::min<int>(least, image.row(v)[u]);
        most = std::max<int>(most, image.row(v)[u]);
      }
    return most - least;
  }
  CaptureClock clock_;
};

TEST_P(VividTest, DeliversPicturesOfThisFormat) {
  V4l2Camera camera(config(GetParam()), clock_);
  const Result<> opened = camera.open();
  if (!opened) GTEST_SKIP() << opened.error().message();  // not every kernel's vivid has every format
  ASSERT_TRUE(camera.start().ok());
  CameraFrame frame;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(receive(camera, frame));
  EXPECT_EQ(frame.view[0].width(), kWidth);
  EXPECT_EQ(frame.view[0].height(), kHeight);
  EXPECT_GT(contrast(frame.view[0]), 100);
}

INSTANTIATE_TEST_SUITE_P(Formats, VividTest,
                         testing::Values("GREY", "Y10", "Y12", "Y16", "YUYV", "UYVY", "NV12", "BA81", "GBRG", "GRBG",
                                         "RGGB"));

TEST_F(VividTest, FramesComeInOrderWithGrowingTimesOfThePast) {
  V4l2Camera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  std::uint64_t last_seq = 0;
  Timestamp last;
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(receive(camera, frame));
    EXPECT_GT(frame.seq, last_seq);
    EXPECT_GT(frame.mid_exposure, last);
    EXPECT_LE(frame.mid_exposure, frame.arrival);
    EXPECT_EQ(frame.time_source, TimeSource::driver);
    last_seq = frame.seq;
    last = frame.mid_exposure;
  }
  EXPECT_EQ(camera.statistics().time_corrections, 0U);
}

TEST_F(VividTest, ASideBySideDeviceGivesTheTwoHalves) {
  CameraFrame whole;
  CameraFrame halves;
  {
    V4l2Camera camera(config(), clock_);
    open(camera);
    ASSERT_TRUE(receive(camera, whole));
  }
  V4l2Config c = config();
  c.side_by_side = true;
  c.width_px = kWidth / 2;
  V4l2Camera camera(c, clock_);
  open(camera);
  ASSERT_TRUE(receive(camera, halves));
  ASSERT_EQ(halves.views, 2);
  EXPECT_EQ(camera.format().width, kWidth / 2);
  // Below the moving text the test card stands still.
  for (int u = 0; u < kWidth / 2; u += 5) {
    EXPECT_NEAR(halves.view[0].row(kHeight / 2)[u], whole.view[0].row(kHeight / 2)[u], 40) << u;
    EXPECT_NEAR(halves.view[1].row(kHeight / 2)[u], whole.view[0].row(kHeight / 2)[u + kWidth / 2], 40) << u;
  }
}

TEST_F(VividTest, TwoDevicesStreamAtOnce) {
  V4l2Camera left(config("GREY", 0), clock_);
  V4l2Camera right(config("GREY", 1), clock_);
  open(left);
  open(right);
  CameraFrame frame;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(receive(left, frame));
    ASSERT_TRUE(receive(right, frame));
  }
}

TEST_F(VividTest, LostBuffersAreAGapInTheCount) {
  V4l2Camera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  ASSERT_TRUE(receive(camera, frame));
  set("percentage_of_dropped_buffers", 40);
  const std::uint64_t before = camera.statistics().skipped;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(receive(camera, frame));
  set("percentage_of_dropped_buffers", 0);
  EXPECT_GT(camera.statistics().skipped, before);
}

TEST_F(VividTest, ABufferMarkedBadIsDroppedAndCounted) {
  V4l2Camera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  ASSERT_TRUE(receive(camera, frame));
  set("inject_v4l2_buf_flag_error", 1);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(receive(camera, frame));
  EXPECT_EQ(camera.statistics().incomplete, 1U);
}

TEST_F(VividTest, StampsOfTheFutureAreReplaced) {
  set("timestamp_source", 0);
  V4l2Camera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(receive(camera, frame));
    EXPECT_LE(frame.mid_exposure - frame.arrival, 2ms);
  }
}

TEST_F(VividTest, AFatalErrorOfTheStreamIsALossAndTheDeviceComesBack) {
  V4l2Camera camera(config(), clock_);
  open(camera);
  CameraFrame frame;
  ASSERT_TRUE(receive(camera, frame));
  const std::uint64_t last_seq = frame.seq;
  set("inject_fatal_streaming_error", 1);
  FrameOutcome outcome = FrameOutcome::frame;
  for (int i = 0; i < 100 && outcome != FrameOutcome::lost; ++i) outcome = camera.next(frame, 200ms);
  EXPECT_EQ(outcome, FrameOutcome::lost);
  open(camera);
  ASSERT_TRUE(receive(camera, frame));
  EXPECT_GT(frame.seq, last_seq);
  EXPECT_EQ(camera.statistics().lost, 1U);
}

TEST_F(VividTest, AnImpossibleSizeIsRefusedWithWhatIsOffered) {
  V4l2Config c = config();
  c.width_px = 1024;
  c.height_px = 768;
  V4l2Camera camera(c, clock_);
  const Result<> opened = camera.open();
  ASSERT_FALSE(opened.ok());
  EXPECT_NE(opened.error().message().find("1280x720"), std::string::npos) << opened.error().message();
}

TEST_F(VividTest, DevicesAreFoundByNameAndByWhatTheyCannot) {
  const std::vector<FoundDevice> found = find_v4l2_devices();
  ASSERT_GE(found.size(), 2U);
  EXPECT_EQ(found[0].path, "/dev/video0");
  EXPECT_NE(found[0].name.find("vivid"), std::string::npos);
  EXPECT_EQ(found[0].problem, "");
}

// The dequeue watchdog: a stream whose buffers are all lost is restarted in place.
TEST_F(VividTest, ASilentStreamIsRestarted) {
  V4l2Config c = config();
  c.watchdog_s = 0.5;
  V4l2Camera camera(c, clock_);
  open(camera);
  CameraFrame frame;
  ASSERT_TRUE(receive(camera, frame));
  set("percentage_of_dropped_buffers", 100);
  for (int i = 0; i < 20 && camera.statistics().restarts == 0; ++i) static_cast<void>(camera.next(frame, 200ms));
  EXPECT_GE(camera.statistics().restarts, 1U);
  set("percentage_of_dropped_buffers", 0);
  EXPECT_TRUE(receive(camera, frame));
}

}  // namespace
}  // namespace pelorus
