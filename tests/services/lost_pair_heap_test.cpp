// Pairs without a pose are shown to the main thread on request (VisionControl::lost_pair_wanted): no heap on the vision
// thread for it. A program of its own, because it counts all allocations of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "services/publish_thread.h"
#include "services/vision.h"
#include "tests/drivers/synthetic/small_dive.h"
#include "tests/support/allocation_count.h"

namespace pelorus {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

TEST(LostPairHeap, ShowingALostPairTakesNone) {
  if (!PELORUS_COUNTS_ALLOCATIONS) GTEST_SKIP() << "a sanitizer's allocator cannot be counted";
  synthetic::SyntheticSource source(synthetic::small_dive());
  const Rectifier rectifier = Rectifier::create(source.calibration(), "scene").value();
  CaptureClock clock;
  FrameRing ring(6, {kWidth, kHeight, 2});
  StereoSync sync(ring);
  PublishDesk desk;
  VisionControl control;
  Mailbox<SourcePair> lost_pairs;
  for (int copy = 0; copy < 3; ++copy) {  // room, as the reader gives it before the start
    lost_pairs.draft().left.resize(kWidth, kHeight);
    lost_pairs.draft().right.resize(kWidth, kHeight);
    (void)lost_pairs.post();
    (void)lost_pairs.fetch();
  }
  CaptureWatchConfig watch;
  watch.frame_timeout_ms = 60'000;  // a loaded machine shall not make a camera fault of a pause
  VisionParts parts{sync, rectifier, desk.results, control, clock};
  parts.lost_pairs = &lost_pairs;
  std::optional<Vision> vision(std::in_place, parts, PipelineConfig{}, watch, TimingConfig{});
  std::uint64_t seq = 0;
  const auto pass = [&](const auto& fill) {
    CameraFrame& slot = ring.slot();
    slot.resize({kWidth, kHeight, 2});
    fill(slot);
    slot.seq = ++seq;
    slot.mid_exposure = slot.arrival = clock.now();
    slot.time_source = TimeSource::hardware;
    ring.publish();
    while (desk.results.front() == nullptr) desk.wake.wait(std::chrono::milliseconds(10));
    const VisionState state = desk.results.front()->result.state;
    desk.results.release();
    return state;
  };
  const auto dark = [&](CameraFrame& slot) {  // each another, or they would be frozen pictures
    for (Image& view : {std::ref(slot.view[0]), std::ref(slot.view[1])}) {
      for (int v = 0; v < kHeight; ++v) std::fill_n(view.row(v), kWidth, static_cast<std::uint8_t>(3 + seq % 7));
    }
  };
  SourcePair pair;
  for (int frame = 0; frame < 3; ++frame) {
    source.render(frame, pair);
    pass([&](CameraFrame& slot) {
      slot.view[0].assign(pair.left.view());
      slot.view[1].assign(pair.right.view());
    });
  }
  for (int i = 0; i < 10; ++i) pass(dark);
  // LOST, and what LOST becomes once the pictures were found exchanged.
  int shown = 0;
  int shown_in_fault = 0;
  const long taken = test::allocations_in([&] {
    for (int i = 0; i < 60; ++i) {
      control.sides_exchanged.store(i >= 30);
      control.lost_pair_wanted.store(true);
      const VisionState state = pass(dark);
      if (lost_pairs.fetch() == nullptr) continue;
      shown += state == VisionState::lost ? 1 : 0;
      shown_in_fault += state == VisionState::calibration_fault ? 1 : 0;
    }
  });
  EXPECT_EQ(taken, 0);
  EXPECT_EQ(shown, 30);
  EXPECT_EQ(shown_in_fault, 30);
  vision.reset();
}

}  // namespace
}  // namespace pelorus
