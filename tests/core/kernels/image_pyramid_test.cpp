#include "core/kernels/image_pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/kernels/downsample.h"
#include "tests/core/kernels/each_target.h"
#include "tests/core/kernels/random_image.h"

namespace pelorus {
namespace {

TEST(ImagePyramid, VectorPathsEqualTheReferenceBitByBit) {
  for_each_target([] {
    for (const int width : {33, 64, 131, 752}) {
      const Image image = test::random_image(width, 40, 7);
      ImagePyramid pyramid;
      pyramid.build(image.view(), 2);
      const ImageView& fine = pyramid.level(0);
      const ImageView& coarse = pyramid.level(1);
      std::vector<std::uint8_t> expected(static_cast<std::size_t>(coarse.width));
      for (int v = 0; v < coarse.height; ++v) {
        reference::downsample_row(fine.row(2 * v), fine.stride, coarse.width, expected.data());
        for (int u = 0; u < coarse.width; ++u) {
          ASSERT_EQ(coarse.row(v)[u], expected[static_cast<std::size_t>(u)]) << width << ": " << u << ' ' << v;
        }
      }
    }
  });
}

TEST(ImagePyramid, ARampKeepsItsPlaceOnEveryLevel) {
  Image ramp(200, 100);
  for (int v = 0; v < 100; ++v) {
    for (int u = 0; u < 200; ++u) ramp.row(v)[u] = static_cast<std::uint8_t>(u + v / 2);
  }
  ImagePyramid pyramid;
  pyramid.build(ramp.view(), 3);
  ASSERT_EQ(pyramid.levels(), 3);
  for (int i = 0; i < 3; ++i) {
    const int scale = 1 << i;
    for (int v = 6; v < 100 / scale - 6; ++v) {
      for (int u = 6; u < 200 / scale - 6; ++u) {
        EXPECT_NEAR(pyramid.level(i).row(v)[u], u * scale + v * scale / 2.0, 1.0) << i;
      }
    }
  }
}

TEST(ImagePyramid, TheBorderRepeatsTheNearestPixel) {
  const Image image = test::random_image(75, 50, 7);
  ImagePyramid pyramid(75, 50, 2);
  pyramid.build(image.view(), 2);
  for (int i = 0; i < 2; ++i) {
    const ImageView& level = pyramid.level(i);
    for (int v = -ImagePyramid::kBorder; v < level.height + ImagePyramid::kBorder; ++v) {
      const std::uint8_t* nearest = level.row(std::clamp(v, 0, level.height - 1));
      for (int u = -ImagePyramid::kBorder; u < level.width + ImagePyramid::kBorder; ++u) {
        ASSERT_EQ(level.row(v)[u], nearest[std::clamp(u, 0, level.width - 1)]) << i << ": " << u << ' ' << v;
      }
    }
  }
}

TEST(ImagePyramid, StorageStaysWhereItIsFromFrameToFrame) {
  const Image image = test::random_image(128, 96, 7);
  ImagePyramid pyramid(128, 96, 3);
  const std::uint8_t* before = pyramid.level(2).pixels;
  pyramid.build(image.view(), 3);
  EXPECT_EQ(pyramid.level(2).pixels, before);
}

TEST(ImagePyramid, ATinyImageGetsTheLevelsItHasRoomFor) {
  const Image image = test::random_image(40, 20, 7);
  ImagePyramid pyramid;
  pyramid.build(image.view(), 6);
  EXPECT_EQ(pyramid.levels(), 1);
}

}  // namespace
}  // namespace pelorus
