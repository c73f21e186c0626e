#include "drivers/frame_ring.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <chrono>
#include <random>
#include <thread>
#include <vector>

namespace pelorus {
namespace {

using namespace std::chrono_literals;

constexpr FrameFormat kSmall{16, 8, 1};

bool publish(FrameRing& ring, std::uint64_t seq) {
  ring.slot().seq = seq;
  return ring.publish();
}

TEST(FrameRing, GivesTheNewestAndCountsTheOthers) {
  FrameRing ring(6, kSmall);
  for (std::uint64_t seq = 1; seq <= 4; ++seq) EXPECT_TRUE(publish(ring, seq));
  EXPECT_EQ(ring.newest()->seq, 4U);
  EXPECT_EQ(ring.drops().superseded, 3U);
  EXPECT_EQ(ring.drops().no_free_slot, 0U);
  EXPECT_FALSE(ring.newest());
}

TEST(FrameRing, DropsTheNewFrameWhenTheConsumerHoldsAllSlots) {
  FrameRing ring(4, kSmall);
  std::vector<FrameLease> held;
  for (std::uint64_t seq = 1; seq <= 3; ++seq) {
    ASSERT_TRUE(publish(ring, seq));
    held.push_back(ring.oldest());
  }
  EXPECT_FALSE(publish(ring, 4));
  EXPECT_EQ(ring.drops().no_free_slot, 1U);
  for (std::uint64_t seq = 1; seq <= 3; ++seq) EXPECT_EQ(held[seq - 1]->seq, seq);  // untouched by the drop
  held.pop_back();
  EXPECT_TRUE(publish(ring, 5));
  EXPECT_EQ(ring.newest()->seq, 5U);
}

TEST(FrameRing, KeepsTheStorageOfItsSlots) {
  FrameRing ring(3, kSmall);
  std::vector<const std::uint8_t*> seen;
  for (std::uint64_t seq = 0; seq < 9; ++seq) {
    ASSERT_TRUE(publish(ring, seq));
    seen.push_back(ring.newest()->view[0].row(0));
  }
  for (std::size_t i = 3; i < seen.size(); ++i) EXPECT_EQ(seen[i], seen[i - 3]);
}

TEST(FrameRing, WakesAConsumerThatWaits) {
  FrameRing ring(3, kSmall);
  EXPECT_FALSE(ring.wait(0ms));
  std::jthread producer([&] {
    std::this_thread::sleep_for(20ms);
    EXPECT_TRUE(publish(ring, 1));
  });
  EXPECT_TRUE(ring.wait(10s));
  EXPECT_EQ(ring.newest()->seq, 1U);
  EXPECT_FALSE(ring.wait(0ms));
}

TEST(FrameRing, AFrameTakenWithoutWaitingDoesNotCutTheNextWaitShort) {
  FrameRing ring(3, kSmall);
  ASSERT_TRUE(publish(ring, 1));
  EXPECT_TRUE(ring.newest());
  std::jthread producer([&] {
    std::this_thread::sleep_for(20ms);
    EXPECT_TRUE(publish(ring, 2));
  });
  EXPECT_TRUE(ring.wait(10s));
}

TEST(FrameRing, ItsDescriptorIsReadableFromAFrameToTheClearing) {
  FrameRing ring(3, kSmall);
  const auto readable = [&] {
    pollfd wake{ring.wake_fd(), POLLIN, 0};
    return ::poll(&wake, 1, 0) == 1;
  };
  EXPECT_FALSE(readable());
  ASSERT_TRUE(publish(ring, 1));
  EXPECT_TRUE(readable());
  ring.clear_wake();
  EXPECT_FALSE(readable());
}

TEST(FrameRing, MovedLeasesGiveBackOnce) {
  FrameRing ring(3, kSmall);
  ASSERT_TRUE(publish(ring, 1));
  FrameLease a = ring.newest();
  FrameLease b = std::move(a);
  EXPECT_FALSE(a);
  b = FrameLease();
  ASSERT_TRUE(publish(ring, 2));
  ASSERT_TRUE(publish(ring, 3));
  EXPECT_EQ(ring.drops().no_free_slot, 0U);
}

// One camera at full speed against a consumer of changing speed: every frame that is read is whole, in order, and
// every frame published is either read or counted as dropped.
TEST(FrameRing, LosesNoFrameUncountedUnderContention) {
  constexpr std::uint64_t kFrames = 20'000;
  FrameRing ring(5, kSmall);
  std::atomic<bool> done{false};
  std::jthread camera([&] {
    for (std::uint64_t seq = 1; seq <= kFrames; ++seq) {
      CameraFrame& frame = ring.slot();
      frame.seq = seq;
      for (int v = 0; v < kSmall.height; ++v)
        std::fill_n(frame.view[0].row(v), kSmall.width, static_cast<std::uint8_t>(seq));
      ring.publish();
    }
    done = true;
  });
  std::mt19937 random(1);
  std::uint64_t read = 0;
  std::uint64_t last = 0;
  std::vector<FrameLease> held;
  while (!done || ring.has_frame()) {
    FrameLease frame = random() % 2 == 0 ? ring.newest() : ring.oldest();
    if (!frame) continue;
    ++read;
    ASSERT_GT(frame->seq, last);
    last = frame->seq;
    for (int v = 0; v < kSmall.height; ++v)
      for (int u = 0; u < kSmall.width; ++u) ASSERT_EQ(frame->view[0].row(v)[u], static_cast<std::uint8_t>(frame->seq));
    held.push_back(std::move(frame));
    if (held.size() > random() % 4) held.clear();
  }
  EXPECT_EQ(read + ring.drops().superseded + ring.drops().no_free_slot, kFrames);
  EXPECT_GT(ring.drops().superseded + ring.drops().no_free_slot, 0U);
}

}  // namespace
}  // namespace pelorus
