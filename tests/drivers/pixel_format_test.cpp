#include "drivers/pixel_format.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pelorus {
namespace {

constexpr int kWidth = 12;
constexpr int kHeight = 6;

// Brightness of the test picture, 0 to 1.
double brightness(int u, int v) { return 0.1 + 0.05 * u + 0.03 * v; }

struct Buffer {
  std::vector<std::uint8_t> bytes;
  RawPicture picture;
};

// Rows are longer than their pixels: strides are obeyed.
Buffer make(PixelFormat format, int bytes_per_pixel, int extra_rows = 0) {
  Buffer b;
  const int stride = kWidth * bytes_per_pixel + 6;
  b.bytes.assign(static_cast<std::size_t>(stride * (kHeight + extra_rows)), 0xEE);
  b.picture = {b.bytes.data(), b.bytes.size(), kWidth, kHeight, stride, format};
  return b;
}

std::uint8_t* at(Buffer& b, int v, int byte) { return b.bytes.data() + v * b.picture.stride + byte; }

void expect_picture(const RawPicture& picture, double tolerance) {
  Image out;
  ASSERT_TRUE(to_gray(picture, 0, kWidth, out));
  ASSERT_EQ(out.width(), kWidth);
  ASSERT_EQ(out.height(), kHeight);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u)
      ASSERT_NEAR(out.row(v)[u], 255 * brightness(u, v), tolerance) << text(picture.format) << " " << u << " " << v;
  // The two halves of a side-by-side picture are the same pixels.
  Image half;
  ASSERT_TRUE(to_gray(picture, kWidth / 2, kWidth / 2, half));
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth / 2; ++u) ASSERT_EQ(half.row(v)[u], out.row(v)[u + kWidth / 2]);
}

TEST(PixelFormat, DeepGrayKeepsItsHighestBits) {
  const struct {
    PixelFormat format;
    int bits;
  } cases[] = {{PixelFormat::gray10, 10}, {PixelFormat::gray12, 12}, {PixelFormat::gray16, 16}};
  for (const auto& c : cases) {
    Buffer b = make(c.format, 2);
    const double top = std::exp2(c.bits) - 1;
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        const auto value = static_cast<unsigned>(std::lround(top * brightness(u, v)));
        *at(b, v, 2 * u) = static_cast<std::uint8_t>(value & 0xFF);
        *at(b, v, 2 * u + 1) = static_cast<std::uint8_t>(value >> 8);
      }
    expect_picture(b.picture, 1.0);
  }
}

TEST(PixelFormat, GrayAndNv12TakeTheFirstPlaneAsItIs) {
  for (const PixelFormat format : {PixelFormat::gray8, PixelFormat::nv12}) {
    Buffer b = make(format, 1, format == PixelFormat::nv12 ? kHeight / 2 : 0);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) *at(b, v, u) = static_cast<std::uint8_t>(std::lround(255 * brightness(u, v)));
    expect_picture(b.picture, 0.5);
  }
}

TEST(PixelFormat, OfPackedYuvTheLumaIsTaken) {
  for (const bool luma_first : {true, false}) {
    Buffer b = make(luma_first ? PixelFormat::yuyv : PixelFormat::uyvy, 2);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u)
        *at(b, v, 2 * u + (luma_first ? 0 : 1)) = static_cast<std::uint8_t>(std::lround(255 * brightness(u, v)));
    expect_picture(b.picture, 0.5);
  }
}

// A gray scene through a mosaic stays what it is (linear brightness is kept by a symmetric kernel except at the
// mirrored border); a coloured one becomes the same gray whatever the order of the mosaic.
TEST(PixelFormat, BayerIsTheSameGrayForEveryOrder) {
  const double color[3] = {0.8, 0.5, 0.2};
  const double gray = 255 * (0.25 * color[0] + 0.5 * color[1] + 0.25 * color[2]);
  for (int order = 0; order < 4; ++order) {
    Buffer b = make(PixelFormat::bayer8, 1);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        const int site = ((u + order) & 1) + ((v + order / 2) & 1);  // 0 red, 1 green, 2 blue
        *at(b, v, u) = static_cast<std::uint8_t>(std::lround(255 * color[site]));
      }
    Image out;
    ASSERT_TRUE(to_gray(b.picture, 0, kWidth, out));
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) EXPECT_NEAR(out.row(v)[u], gray, 1.0) << order << " " << u << " " << v;
  }
}

TEST(PixelFormat, BayerKeepsALinearScene) {
  Buffer b = make(PixelFormat::bayer8, 1);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) *at(b, v, u) = static_cast<std::uint8_t>(std::lround(255 * brightness(u, v)));
  Image out;
  ASSERT_TRUE(to_gray(b.picture, 0, kWidth, out));
  for (int v = 1; v + 1 < kHeight; ++v)
    for (int u = 1; u + 1 < kWidth; ++u) EXPECT_NEAR(out.row(v)[u], 255 * brightness(u, v), 1.0);
  Image half;
  ASSERT_TRUE(to_gray(b.picture, kWidth / 2, kWidth / 2, half));
  for (int u = 0; u < kWidth / 2; ++u) EXPECT_EQ(half.row(2)[u], out.row(2)[u + kWidth / 2]);
}

TEST(PixelFormat, BitsAboveTheDepthDoNotWrap) {
  Buffer b = make(PixelFormat::gray10, 2);
  *at(b, 0, 0) = 0x00;
  *at(b, 0, 1) = 0x04;
  Image out;
  ASSERT_TRUE(to_gray(b.picture, 0, kWidth, out));
  EXPECT_EQ(out.row(0)[0], 255);
}

TEST(PixelFormat, AShortBufferIsRefused) {
  Image out;
  for (const PixelFormat format : {PixelFormat::gray8, PixelFormat::gray16, PixelFormat::yuyv, PixelFormat::bayer8}) {
    Buffer b = make(format, 2);
    b.picture.size = least_size(b.picture);
    EXPECT_TRUE(to_gray(b.picture, 0, kWidth, out));
    b.picture.size -= 1;
    EXPECT_FALSE(to_gray(b.picture, 0, kWidth, out)) << text(format);
  }
  Buffer b = make(PixelFormat::gray8, 1);
  EXPECT_FALSE(to_gray(b.picture, 1, kWidth, out));
  EXPECT_FALSE(to_gray(b.picture, -1, 2, out));
  b.picture.format = PixelFormat::mjpeg;
  EXPECT_FALSE(to_gray(b.picture, 0, kWidth, out));
}

}  // namespace
}  // namespace pelorus
