#include "drivers/aravis/frame_id.h"

#include <gtest/gtest.h>

namespace pelorus {
namespace {

TEST(FrameIdUnwrapper, CountsOverTheWrapThatSkipsZero) {
  FrameIdUnwrapper ids;
  std::uint64_t seq = 0;
  std::uint64_t id = 65400;
  for (int i = 0; i < 1000; ++i) {
    seq += ids.advance(id);
    EXPECT_EQ(seq, static_cast<std::uint64_t>(i + 1));
    id = id == 65535 ? 1 : id + 1;
  }
}

TEST(FrameIdUnwrapper, LostFramesAreAGap) {
  FrameIdUnwrapper ids;
  EXPECT_EQ(ids.advance(10), 1U);
  EXPECT_EQ(ids.advance(14), 4U);
  EXPECT_EQ(ids.advance(14), 0U);
  EXPECT_EQ(ids.advance(65534), 1U);  // no camera loses half an hour: it restarted
  EXPECT_EQ(ids.advance(2), 3U);      // 65535, 1, 2
}

TEST(FrameIdUnwrapper, ARestartedCameraCountsOn) {
  FrameIdUnwrapper ids;
  EXPECT_EQ(ids.advance(40000), 1U);
  EXPECT_EQ(ids.advance(20000), 1U);
  ids.restart();
  EXPECT_EQ(ids.advance(25000), 1U);
}

TEST(FrameIdUnwrapper, ExtendedIdsDoNotWrapAtSixteenBits) {
  FrameIdUnwrapper ids;
  EXPECT_EQ(ids.advance(65534), 1U);
  EXPECT_EQ(ids.advance(65537), 3U);
  EXPECT_EQ(ids.advance(std::uint64_t{1} << 40), 1U);
  EXPECT_EQ(ids.advance((std::uint64_t{1} << 40) + 2), 2U);
}

}  // namespace
}  // namespace pelorus
