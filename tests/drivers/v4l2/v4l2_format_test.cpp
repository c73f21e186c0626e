#include "drivers/v4l2/v4l2_format.h"

#include <gtest/gtest.h>

#include <chrono>

namespace pelorus {
namespace {

using namespace std::chrono_literals;

constexpr ExposureTiming kTiming{.exposure = 8ms, .readout = 5ms};

class FrameTimeTest : public testing::Test {
 protected:
  // A buffer stamped `before_arrival` earlier than it arrived.
  FrameTime time(Duration before_arrival, std::uint32_t flags) const {
    const std::int64_t ns = (arrival_ + -before_arrival).ns - clock_.from_monotonic(0).ns;
    v4l2_buffer buffer{};
    buffer.timestamp.tv_sec = ns / 1'000'000'000;
    buffer.timestamp.tv_usec = ns % 1'000'000'000 / 1000;
    buffer.flags = flags;
    return frame_time(buffer, kTiming, clock_, arrival_);
  }
  // Of mid-exposure before arrival; stamps have microseconds.
  std::int64_t age_us(const FrameTime& t) const { return (arrival_ - t.mid_exposure) / 1us; }

  CaptureClock clock_;
  Timestamp arrival_ = clock_.now();
};

TEST_F(FrameTimeTest, StampsOfTheStartOfExposureMoveForwardByHalfOfIt) {
  const FrameTime t = time(20ms, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  EXPECT_NEAR(static_cast<double>(age_us(t)), 16'000, 2);
  EXPECT_EQ(t.source, TimeSource::driver);
}

TEST_F(FrameTimeTest, StampsOfTheLastPixelMoveBackByReadoutAndHalfTheExposure) {
  const FrameTime t = time(3ms, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF);
  EXPECT_NEAR(static_cast<double>(age_us(t)), 12'000, 2);
}

TEST_F(FrameTimeTest, TheSameExposureHasTheSameTimeHoweverItIsStamped) {
  const FrameTime start = time(23ms, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  const FrameTime end = time(10ms, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF);
  EXPECT_NEAR(static_cast<double>(age_us(start)), static_cast<double>(age_us(end)), 2);
}

TEST_F(FrameTimeTest, StampsOfAnUnknownClockAreNotBelieved) {
  const FrameTime t = time(20ms, V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN | V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  EXPECT_EQ(t.source, TimeSource::arrival);
  EXPECT_EQ(t.mid_exposure, arrival_);
  EXPECT_FALSE(t.corrected);
}

TEST_F(FrameTimeTest, StampsOfTheFutureAndOfLongAgoAreReplacedAndToldOf) {
  for (const Duration before : {Duration(-31ms), Duration(1h)}) {
    const FrameTime t = time(before, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC);
    EXPECT_EQ(t.mid_exposure, arrival_);
    EXPECT_TRUE(t.corrected);
  }
}

TEST_F(FrameTimeTest, CopiedStampsAreTakenWhenTheyCanBe) {
  EXPECT_EQ(time(20ms, V4L2_BUF_FLAG_TIMESTAMP_COPY).source, TimeSource::driver);
  EXPECT_EQ(time(24h, V4L2_BUF_FLAG_TIMESTAMP_COPY).source, TimeSource::arrival);
}

TEST(DequeueLimit, ASlowCameraHasThreePeriods) {
  EXPECT_EQ(dequeue_limit(0.75, 25), 750ms);
  EXPECT_EQ(dequeue_limit(0.75, 4), 750ms);
  EXPECT_EQ(dequeue_limit(0.75, 1), 3s);
  EXPECT_EQ(dequeue_limit(0.75, 0.5), 6s);
  EXPECT_EQ(dequeue_limit(0.75, 0), 750ms) << "rate unknown";
}

TEST(Fourcc, NamesAndCodesAreTwoFormsOfOne) {
  for (const char* name :
       {"GREY", "Y10 ", "Y12 ", "Y16 ", "YUYV", "UYVY", "NV12", "MJPG", "BA81", "GBRG", "GRBG", "RGGB"}) {
    EXPECT_EQ(fourcc_name(fourcc(name)), name);
    EXPECT_NE(pixel_format(fourcc(name)), PixelFormat::unknown) << name;
  }
  EXPECT_EQ(fourcc("Y10"), V4L2_PIX_FMT_Y10);
  EXPECT_EQ(fourcc("GREY"), V4L2_PIX_FMT_GREY);
  EXPECT_EQ(fourcc(""), 0U);
  EXPECT_EQ(fourcc("GREYS"), 0U);
  EXPECT_EQ(pixel_format(V4L2_PIX_FMT_RGB24), PixelFormat::unknown);
}

}  // namespace
}  // namespace pelorus
