#include "drivers/stereo_sync.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace pelorus {
namespace {

using namespace std::chrono_literals;

constexpr FrameFormat kSmall{8, 4, 1};
constexpr std::int64_t kPeriodNs = 50'000'000;

class StereoSyncTest : public testing::Test {
 protected:
  static void publish(FrameRing& ring, std::uint64_t seq, std::int64_t time_ns) {
    ring.slot().seq = seq;
    ring.slot().mid_exposure.ns = time_ns;
    ring.publish();
  }
  void left(std::uint64_t seq, std::int64_t late_ns = 0) {
    publish(left_, seq, static_cast<std::int64_t>(seq) * kPeriodNs + late_ns);
  }
  // The right camera's count may start elsewhere.
  void right(std::uint64_t seq, std::int64_t late_ns = 0, std::uint64_t count_offset = 0) {
    publish(right_, seq + count_offset, static_cast<std::int64_t>(seq) * kPeriodNs + late_ns);
  }

  FrameRing left_{8, kSmall};
  FrameRing right_{8, kSmall};
  StereoSync by_time_{left_, right_, {PairBy::time, 2.0}};
  StereoSync by_count_{left_, right_, {PairBy::sequence, 2.0}};
};

TEST_F(StereoSyncTest, PairsFramesOfOneExposureAndMeasuresTheirError) {
  left(10);
  right(10, 300'000);
  const StereoPair pair = by_time_.newest(0ms);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair.seq, 10U);
  EXPECT_EQ(pair.sync_error, 300us);
  EXPECT_EQ(pair.capture_time.ns, 10 * kPeriodNs + 150'000);
  EXPECT_EQ(by_time_.statistics().last_error_ns, 300'000);
  EXPECT_FALSE(by_time_.newest(0ms));
}

// One outlier does not hide what comes after it.
TEST_F(StereoSyncTest, TheWorstErrorIsThatSinceItWasTakenLast) {
  EXPECT_FALSE(by_time_.take_worst_error_ns());
  const std::int64_t errors_ns[] = {300'000, -1'500'000, 200'000};
  for (std::uint64_t seq = 1; seq <= 3; ++seq) {
    left(seq);
    right(seq, errors_ns[seq - 1]);
    EXPECT_TRUE(by_time_.newest(0ms));
  }
  EXPECT_EQ(by_time_.take_worst_error_ns(), -1'500'000);
  left(4);
  right(4, 400'000);
  EXPECT_TRUE(by_time_.newest(0ms));
  EXPECT_EQ(by_time_.take_worst_error_ns(), 400'000);
  EXPECT_FALSE(by_time_.take_worst_error_ns()) << "no pair since";
}

TEST_F(StereoSyncTest, GivesTheNewestPairAndCountsTheOthers) {
  for (std::uint64_t seq = 1; seq <= 6; ++seq) {
    left(seq);
    right(seq);
  }
  EXPECT_EQ(by_time_.newest(0ms).seq, 6U);
  EXPECT_EQ(by_time_.statistics().superseded, 5U);
  EXPECT_EQ(by_time_.statistics().unpaired_left + by_time_.statistics().unpaired_right, 0U);
}

TEST_F(StereoSyncTest, AMissingFrameCostsOnlyItsPair) {
  left(1);
  right(1);
  left(2);  // right 2 is lost
  left(3);
  right(3);
  EXPECT_EQ(by_time_.newest(0ms).seq, 3U);
  EXPECT_EQ(by_time_.statistics().unpaired_left, 1U);
  EXPECT_EQ(by_time_.statistics().unpaired_right, 0U);
}

TEST_F(StereoSyncTest, APartnerMayComeLate) {
  left(1);
  left(2);
  EXPECT_FALSE(by_time_.newest(0ms));
  right(1);
  EXPECT_EQ(by_time_.newest(0ms).seq, 1U);
  right(2);
  EXPECT_EQ(by_time_.newest(0ms).seq, 2U);
}

TEST_F(StereoSyncTest, ACameraAloneIsDroppedAndTheOtherOneFindsBack) {
  for (std::uint64_t seq = 1; seq <= 20; ++seq) {
    left(seq);
    EXPECT_FALSE(by_time_.newest(0ms));
  }
  EXPECT_EQ(by_time_.statistics().unpaired_left, 20U - StereoSync::kWaiting);
  EXPECT_EQ(left_.drops().no_free_slot, 0U);
  left(21);
  right(21);
  EXPECT_EQ(by_time_.newest(0ms).seq, 21U);
}

TEST_F(StereoSyncTest, OfTwoWithinToleranceTheNearerOneIsThePartner) {
  publish(left_, 1, 1'000'000'000);
  publish(right_, 1, 998'500'000);
  publish(right_, 2, 1'000'100'000);
  const StereoPair pair = by_time_.newest(0ms);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair.second->seq, 2U);
}

TEST_F(StereoSyncTest, TimeThatJumpedForwardAndBackBlocksNothing) {
  left(1);
  right(1);
  EXPECT_TRUE(by_time_.newest(0ms));
  for (std::uint64_t seq = 2; seq <= 4; ++seq) {
    left(seq, 3'600'000'000'000);
    right(seq);
    EXPECT_FALSE(by_time_.newest(0ms));
  }
  left(5);
  right(5);
  EXPECT_EQ(by_time_.newest(0ms).seq, 5U);
  EXPECT_EQ(by_time_.statistics().unpaired_right, 3U);
  EXPECT_EQ(by_time_.statistics().time_reversed, 3U);
}

TEST_F(StereoSyncTest, CountsPairWhereTimesAloneAreTooCoarse) {
  // Stamps of arrival: noise of 20 ms at a period of 50 ms.
  StereoSync sync(left_, right_, {PairBy::sequence, 24.0});
  left(1);
  right(1, 0, 700);
  EXPECT_EQ(sync.newest(0ms).seq, 1U);  // the offset between the counts is found by time
  left(2, 20'000'000);
  right(2, 0, 700);
  left(3);
  right(3, 20'000'000, 700);
  EXPECT_EQ(sync.newest(0ms).seq, 3U);
  EXPECT_EQ(sync.statistics().superseded, 1U);
  EXPECT_EQ(sync.statistics().realigned, 1U);
}

TEST_F(StereoSyncTest, FramesOfEqualCountWhoseTimesDisagreeAreNoPair) {
  left(1);
  right(1);
  EXPECT_TRUE(by_count_.newest(0ms));
  left(2);
  right(2, 30'000'000);
  EXPECT_FALSE(by_count_.newest(0ms));
  EXPECT_EQ(by_count_.statistics().out_of_tolerance, 1U);
}

TEST_F(StereoSyncTest, CountsAreAlignedAnewAfterACameraRestarted) {
  left(1);
  right(1);
  EXPECT_TRUE(by_count_.newest(0ms));
  StereoPair pair;
  std::uint64_t seq = 100;
  // The right camera was away and counts on from where it was.
  for (; seq < 110 && !pair; ++seq) {
    left(seq);
    publish(right_, seq - 98, static_cast<std::int64_t>(seq) * kPeriodNs);
    pair = by_count_.newest(0ms);
  }
  EXPECT_TRUE(pair);
  EXPECT_LE(seq, 105U);
  EXPECT_EQ(by_count_.statistics().realigned, 2U);
}

TEST(StereoSyncOfOneDevice, GivesBothViewsOfTheNewestFrame) {
  FrameRing ring(4, {8, 4, 2});
  StereoSync sync(ring);
  for (std::uint64_t seq = 1; seq <= 2; ++seq) {
    ring.slot().seq = seq;
    ring.slot().view[0].row(0)[0] = 1;
    ring.slot().view[1].row(0)[0] = 2;
    ring.publish();
  }
  const StereoPair pair = sync.newest(0ms);
  EXPECT_EQ(pair.seq, 2U);
  EXPECT_EQ(pair.left().row(0)[0], 1);
  EXPECT_EQ(pair.right().row(0)[0], 2);
  EXPECT_EQ(sync.statistics().superseded, 1U);
}

// Two cameras at full speed, one of which loses every seventh frame, and a consumer: no false pair, no frame
// unaccounted for.
TEST(StereoSyncContention, AccountsForEveryFrameOfTwoCameras) {
  constexpr std::uint64_t kFrames = 5'000;
  FrameRing left(8, kSmall);
  FrameRing right(8, kSmall);
  StereoSync sync(left, right, {PairBy::time, 1.0});
  std::atomic<int> running{2};
  const auto film = [&](FrameRing& ring, std::uint64_t lost_every, std::uint64_t& published) {
    for (std::uint64_t seq = 1; seq <= kFrames; ++seq) {
      if (seq % lost_every == 0) continue;
      ring.slot().seq = seq;
      ring.slot().mid_exposure.ns = static_cast<std::int64_t>(seq) * kPeriodNs;
      std::fill_n(ring.slot().view[0].row(0), kSmall.width, static_cast<std::uint8_t>(seq));
      published += ring.publish() ? 1 : 0;
      if (seq % 16 == 0) std::this_thread::yield();
    }
    --running;
  };
  std::uint64_t published_left = 0;
  std::uint64_t published_right = 0;
  {
    std::jthread left_camera([&] { film(left, kFrames + 1, published_left); });
    std::jthread right_camera([&] { film(right, 7, published_right); });
    std::uint64_t last = 0;
    while (running > 0 || (left.has_frame() && right.has_frame())) {
      const StereoPair pair = sync.newest(1ms);
      if (!pair) continue;
      ASSERT_GT(pair.seq, last);
      last = pair.seq;
      ASSERT_EQ(pair.first->seq, pair.second->seq);
      ASSERT_EQ(pair.left().row(0)[0], pair.right().row(0)[0]);
    }
  }
  while (sync.newest(0ms)) {
  }
  const SyncStatistics s = sync.statistics();
  const std::uint64_t paired = s.pairs + s.superseded;
  EXPECT_GT(s.pairs, 0U);
  // At the end at most kWaiting frames of one side still wait for a partner.
  EXPECT_LE(published_left - paired - s.unpaired_left, StereoSync::kWaiting);
  EXPECT_LE(published_right - paired - s.unpaired_right, StereoSync::kWaiting);
}

}  // namespace
}  // namespace pelorus
