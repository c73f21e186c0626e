// Logs written by liblcm itself, read back by our own reader.
#include "drivers/replay/lcm_log.h"

#include <gtest/gtest.h>

#include <bot_core/images_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <opencv2/imgcodecs.hpp>

#include "drivers/replay/dataset.h"
#include "drivers/replay/lcm_event_file.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

constexpr int kWidth = 64, kHeight = 48, kPairs = 6;
constexpr std::int64_t kStart_us = 1'600'000'000'000'000, kPeriod_us = 50'000;

std::uint8_t grey(int pair, int side, int u, int v) {
  return static_cast<std::uint8_t>(40 + 10 * pair + 5 * side + (u * 7 + v * 13) % 50);
}

bot_core::image_t gray_image(int pair, int side, int row_stride) {
  bot_core::image_t image{};
  image.width = kWidth;
  image.height = kHeight;
  image.row_stride = row_stride;
  image.pixelformat = bot_core::image_t::PIXEL_FORMAT_GRAY;
  image.data.resize(static_cast<std::size_t>(row_stride * kHeight));
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) image.data[static_cast<std::size_t>(v * row_stride + u)] = grey(pair, side, u, v);
  }
  image.size = static_cast<std::int32_t>(image.data.size());
  image.nmetadata = 1;
  image.metadata.resize(1);
  image.metadata[0].key = "exposure";
  image.metadata[0].value = {1, 2, 3};
  image.metadata[0].n = 3;
  return image;
}

bot_core::image_t jpeg_image(int pair, int side) {
  bot_core::image_t image = gray_image(pair, side, kWidth);
  const cv::Mat smooth(kHeight, kWidth, CV_8U, cv::Scalar(100 + 10 * pair + 5 * side));
  image.pixelformat = bot_core::image_t::PIXEL_FORMAT_MJPEG;
  cv::imencode(".jpg", smooth, image.data);
  image.size = static_cast<std::int32_t>(image.data.size());
  return image;
}

class LcmLog : public ::testing::Test {
 protected:
  LcmLog() {
    given_.origin = "test";
    for (CameraIntrinsics* camera : {&given_.calibration.left, &given_.calibration.right}) {
      *camera = {.width = kWidth, .height = kHeight, .fx_px = 60, .fy_px = 60, .cx_px = 32, .cy_px = 24};
    }
    given_.calibration.T_right_left.translation().x() = -0.1;
    given_.calibration.rectified = true;
  }
  [[nodiscard]] std::string path() const { return (folder_.path() / "dive.lcmlog").string(); }
  // `skip`: this pair was never logged. Other messages lie in between, the right picture comes first.
  void write(bool jpeg, int skip = -1) {
    lcm::LCM log("file://" + path() + "?mode=w");
    for (int i = 0; i < kPairs; ++i) {
      bot_core::image_t other{};
      log.publish("OTHER", &other);
      if (i == skip) continue;
      bot_core::images_t pair{};
      pair.utime = kStart_us + i * kPeriod_us;
      pair.n_images = 2;
      pair.image_types = {bot_core::images_t::RIGHT, bot_core::images_t::LEFT};
      for (const int side : {1, 0})
        pair.images.push_back(jpeg ? jpeg_image(i, side) : gray_image(i, side, kWidth + 16));
      log.publish("CAMERA", &pair);
    }
  }
  test::TemporaryFolder folder_;
  LoadedCalibration given_;
};

TEST_F(LcmLog, GrayPairsComeBackToTheGreyLevel) {
  write(false);
  auto source = open_dataset(path(), given_);
  ASSERT_TRUE(source.ok()) << source.error().message();
  EXPECT_EQ(source.value()->pair_count(), static_cast<std::size_t>(kPairs));
  EXPECT_NE(source.value()->description().find("channel CAMERA"), std::string::npos);
  SourcePair pair;
  for (int i = 0; i < kPairs; ++i) {
    const auto more = source.value()->next(pair);
    ASSERT_TRUE(more.ok() && more.value());
    EXPECT_EQ(pair.seq, static_cast<std::uint64_t>(i));
    EXPECT_EQ(pair.capture_time.ns, (kStart_us + i * kPeriod_us) * 1000);
    int different = 0;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        different += pair.left.row(v)[u] != grey(i, 0, u, v) || pair.right.row(v)[u] != grey(i, 1, u, v) ? 1 : 0;
      }
    }
    EXPECT_EQ(different, 0) << "pair " << i;
  }
  EXPECT_FALSE(source.value()->next(pair).value());
}

TEST_F(LcmLog, JpegPairsComeBackAndAGapStaysAGap) {
  write(true, 2);
  auto source = open_dataset(path(), given_);
  ASSERT_TRUE(source.ok()) << source.error().message();
  SourcePair pair;
  std::vector<std::uint64_t> numbers;
  while (source.value()->next(pair).value()) {
    numbers.push_back(pair.seq);
    const int i = static_cast<int>(pair.seq);
    EXPECT_NEAR(pair.left.row(20)[20], 100 + 10 * i, 2);
    EXPECT_NEAR(pair.right.row(20)[20], 105 + 10 * i, 2);
  }
  EXPECT_EQ(numbers, (std::vector<std::uint64_t>{0, 1, 3, 4, 5}));
}

TEST_F(LcmLog, ATruncatedTailAndBrokenBytesCostTheirPairsOnly) {
  write(false);
  std::string content = test::read_text(path());
  const std::size_t second = content.find("CAMERA", content.find("CAMERA") + 1);
  content[second - 28] = 'x';            // sync word of pair 1
  content.resize(content.size() - 100);  // end of the last pair
  test::write_text(path(), content);
  auto source = open_dataset(path(), given_);
  ASSERT_TRUE(source.ok()) << source.error().message();
  EXPECT_EQ(source.value()->pair_count(), static_cast<std::size_t>(kPairs - 2));
  EXPECT_NE(source.value()->description().find("skipped"), std::string::npos) << source.value()->description();
}

TEST_F(LcmLog, ADamagedFirstPictureCostsItsPairOnly) {
  write(true);
  std::string content = test::read_text(path());
  const std::size_t start = content.find("\xFF\xD8\xFF");
  content.replace(start, 3, "xyz");
  test::write_text(path(), content);
  auto source = open_dataset(path(), given_);
  ASSERT_TRUE(source.ok()) << source.error().message();
  SourcePair pair;
  EXPECT_FALSE(source.value()->next(pair).ok());
  ASSERT_TRUE(source.value()->next(pair).value());
  EXPECT_EQ(pair.seq, 1U);
}

TEST_F(LcmLog, WhatCannotBeUsedSaysWhy) {
  write(false);
  EXPECT_EQ(open_dataset(path()).error().code, ErrorCode::bad_calibration);
  LoadedCalibration other = given_;
  other.calibration.left.width = other.calibration.right.width = 128;
  EXPECT_NE(open_dataset(path(), other).error().message().find("128x48"), std::string::npos);
  {
    lcm::LCM log("file://" + path() + "?mode=w");
    const bot_core::image_t single = gray_image(0, 0, kWidth);
    log.publish("CAMERA", &single);
  }
  EXPECT_NE(open_dataset(path(), given_).error().message().find("images_t"), std::string::npos);
}

TEST_F(LcmLog, OnlyLogsAreTakenForLogs) {
  write(false);
  EXPECT_TRUE(LcmEventFile::is_log(path()));
  test::write_text(folder_.path() / "scene.yaml", "name: x\n");
  EXPECT_FALSE(LcmEventFile::is_log(folder_.path() / "scene.yaml"));
  EXPECT_FALSE(LcmEventFile::is_log(folder_.path()));
  EXPECT_FALSE(LcmEventFile::is_log(folder_.path() / "absent"));
}

}  // namespace
}  // namespace pelorus
