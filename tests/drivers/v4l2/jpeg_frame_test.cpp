#include "drivers/v4l2/jpeg_frame.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <vector>

namespace pelorus {
namespace {

std::vector<std::uint8_t> packed(int width, int height) {
  cv::Mat gray(height, width, CV_8U);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) gray.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(2 * u + v);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", gray, bytes, {cv::IMWRITE_JPEG_QUALITY, 95});
  return bytes;
}

RawPicture picture(const std::vector<std::uint8_t>& bytes, std::size_t size) {
  return {bytes.data(), size, 64, 48, 0, PixelFormat::mjpeg};
}

TEST(JpegFrame, DecodesToGrayThatSplitsIntoTwoViews) {
  const std::vector<std::uint8_t> bytes = packed(64, 48);
  JpegFrame frame;
  ASSERT_TRUE(frame.decode(picture(bytes, bytes.size())));
  Image right;
  ASSERT_TRUE(to_gray(frame.gray(), 32, 32, right));
  for (int v = 0; v < 48; v += 5)
    for (int u = 0; u < 32; u += 3) EXPECT_NEAR(right.row(v)[u], 2 * (u + 32) + v, 3);
}

TEST(JpegFrame, RefusesBrokenPicturesAndOtherSizes) {
  JpegFrame frame;
  const std::vector<std::uint8_t> bytes = packed(64, 48);
  EXPECT_FALSE(frame.decode(picture(bytes, 20)));
  EXPECT_FALSE(frame.decode(picture(bytes, 0)));
  const std::vector<std::uint8_t> noise(1000, 0x5A);
  EXPECT_FALSE(frame.decode(picture(noise, noise.size())));
  const std::vector<std::uint8_t> other = packed(32, 48);
  EXPECT_FALSE(frame.decode(picture(other, other.size())));
  EXPECT_TRUE(frame.decode(picture(bytes, bytes.size())));
}

}  // namespace
}  // namespace pelorus
