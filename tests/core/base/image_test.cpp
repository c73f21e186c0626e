#include "core/base/image.h"

#include <gtest/gtest.h>

namespace pelorus {
namespace {

TEST(Image, MovedFromIsEmptyAndCanBeUsedAgain) {
  Image image(8, 4);
  image.row(3)[7] = 200;
  Image taken = std::move(image);
  EXPECT_EQ(taken.row(3)[7], 200);
  EXPECT_TRUE(image.empty());  // NOLINT(bugprone-use-after-move): what it holds then is the point
  image.resize(8, 4);
  ASSERT_NE(image.row(0), nullptr);
  image.row(3)[7] = 100;
  EXPECT_EQ(taken.row(3)[7], 200);
}

TEST(Image, KeepsItsStorageWhenTheSizeStays) {
  Image image(8, 4);
  const std::uint8_t* before = image.row(0);
  image.resize(8, 4);
  EXPECT_EQ(image.row(0), before);
}

}  // namespace
}  // namespace pelorus
