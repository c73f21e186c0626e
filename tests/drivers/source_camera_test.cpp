#include "drivers/source_camera.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace pelorus {
namespace {

using namespace std::chrono_literals;

// Pairs of given sequence numbers, `period` apart, whose pixels hold their number.
class CountingSource final : public StereoSource {
 public:
  CountingSource(std::vector<std::uint64_t> seqs, Duration period) : seqs_(std::move(seqs)), period_(period) {
    calibration_.left.width = 8;
    calibration_.left.height = 4;
  }
  const StereoCalibration& calibration() const override { return calibration_; }
  std::size_t pair_count() const override { return seqs_.size(); }
  std::string description() const override { return "counting"; }
  Result<bool> next(SourcePair& pair) override {
    if (next_ == seqs_.size()) return false;
    const std::uint64_t seq = seqs_[next_++];
    if (seq == kBroken) return Error{ErrorCode::bad_input, "frame", "broken", ""};
    pair.seq = seq;
    pair.capture_time = Timestamp{1'000'000'000'000} + period_ * static_cast<std::int64_t>(seq);
    pair.left.resize(8, 4);
    pair.right.resize(8, 4);
    pair.left.row(0)[0] = static_cast<std::uint8_t>(seq);
    pair.right.row(0)[0] = static_cast<std::uint8_t>(100 + seq);
    return true;
  }
  static constexpr std::uint64_t kBroken = 999;

 private:
  std::vector<std::uint64_t> seqs_;
  Duration period_;
  StereoCalibration calibration_;
  std::size_t next_ = 0;
};

SourceCamera::OpenSource counting(std::vector<std::uint64_t> seqs, Duration period) {
  return [=]() -> Result<std::unique_ptr<StereoSource>> {
    return std::unique_ptr<StereoSource>(std::make_unique<CountingSource>(seqs, period));
  };
}

void open(SourceCamera& camera) {
  ASSERT_TRUE(camera.open().ok());
  ASSERT_TRUE(camera.start().ok());
}

TEST(SourceCamera, GivesEveryPairStampedAsFarApartAsRecorded) {
  const CaptureClock clock;
  const Timestamp before = clock.now();
  SourceCamera camera(counting({0, 1, 2, 3}, 10ms), {}, clock);
  open(camera);
  EXPECT_EQ(camera.format().views, 2);
  std::vector<Timestamp> times;
  CameraFrame frame;
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
    EXPECT_EQ(frame.view[0].row(0)[0], i);
    EXPECT_EQ(frame.view[1].row(0)[0], 100 + i);
    EXPECT_GE(frame.arrival, frame.mid_exposure);  // never before it was exposed
    EXPECT_GE(frame.mid_exposure, before);         // on the capture clock
    times.push_back(frame.mid_exposure);
  }
  // A loaded machine may only make a pair later, never earlier.
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GE(times[i] - times[i - 1], 10ms);
  if (camera.late() == 0) {
    EXPECT_EQ(times[3] - times[0], 30ms);
  }
  EXPECT_EQ(camera.next(frame, 10s), FrameOutcome::ended);
  EXPECT_EQ(camera.statistics().frames, 4U);
}

TEST(SourceCamera, KeepsAPairThatIsNotDueYet) {
  const CaptureClock clock;
  SourceCamera camera(counting({0, 1}, 60ms), {}, clock);
  open(camera);
  CameraFrame frame;
  ASSERT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
  EXPECT_EQ(camera.next(frame, 0ms), FrameOutcome::timeout);
  EXPECT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
  EXPECT_EQ(frame.view[0].row(0)[0], 1);
  EXPECT_EQ(camera.statistics().timeouts, 1U);
}

TEST(SourceCamera, ARateReplacesTheRecordedTimes) {
  const CaptureClock clock;
  SourceCamera camera(counting({0, 1, 2}, 1h), {.rate_hz = 500}, clock);
  open(camera);
  CameraFrame frame;
  Timestamp last;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
    if (i > 0) {
      EXPECT_GE(frame.mid_exposure - last, 2ms);
    }
    last = frame.mid_exposure;
  }
}

TEST(SourceCamera, LostPairsLeaveAGapAndTheirTime) {
  const CaptureClock clock;
  SourceCamera camera(counting({0, 3}, 5ms), {}, clock);
  open(camera);
  CameraFrame frame;
  ASSERT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
  const std::uint64_t first = frame.seq;
  const Timestamp first_time = frame.mid_exposure;
  ASSERT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
  EXPECT_EQ(frame.seq - first, 3U);
  EXPECT_GE(frame.mid_exposure - first_time, 15ms);
  EXPECT_EQ(camera.statistics().skipped, 2U);
}

TEST(SourceCamera, ABrokenPairIsDroppedAndCounted) {
  const CaptureClock clock;
  SourceCamera camera(counting({0, CountingSource::kBroken, 2}, 1ms), {}, clock);
  open(camera);
  CameraFrame frame;
  EXPECT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
  EXPECT_EQ(camera.next(frame, 10s), FrameOutcome::dropped);
  EXPECT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
  EXPECT_EQ(camera.statistics().incomplete, 1U);
  EXPECT_EQ(camera.statistics().skipped, 0U) << "the gap is the broken pair, counted already";
}

TEST(SourceCamera, ABrokenPairInALongerGapIsCountedOnce) {
  const CaptureClock clock;
  SourceCamera camera(counting({0, CountingSource::kBroken, 4, 6}, 1ms), {}, clock);
  open(camera);
  CameraFrame frame;
  int frames = 0;
  for (int i = 0; i < 4; ++i) frames += camera.next(frame, 10s) == FrameOutcome::frame ? 1 : 0;
  EXPECT_EQ(frames, 3);
  EXPECT_EQ(camera.statistics().incomplete, 1U);
  EXPECT_EQ(camera.statistics().skipped, 2U + 1U) << "2 and 3 of 1 to 3; 5";
}

TEST(SourceCamera, RepeatsWithGrowingCountAndTime) {
  const CaptureClock clock;
  SourceCamera camera(counting({0, 1}, 1ms), {.rate_hz = 1000, .repeat = true}, clock);
  open(camera);
  CameraFrame frame;
  std::uint64_t last_seq = 0;
  Timestamp last;
  for (int i = 0; i < 7; ++i) {
    ASSERT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
    EXPECT_EQ(frame.view[0].row(0)[0], i % 2);
    EXPECT_EQ(frame.seq, last_seq + 1);
    EXPECT_GT(frame.mid_exposure, last);
    last_seq = frame.seq;
    last = frame.mid_exposure;
  }
}

TEST(SourceCamera, ASourceTooSlowMakesItsWorldWait) {
  const CaptureClock clock;
  SourceCamera camera(counting({0, 1, 2}, 1ms), {}, clock);
  open(camera);
  CameraFrame frame;
  ASSERT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
  std::this_thread::sleep_for(30ms);
  const Timestamp now = clock.now();
  ASSERT_EQ(camera.next(frame, 10s), FrameOutcome::frame);
  EXPECT_GE(frame.mid_exposure, now);
  EXPECT_GE(camera.late(), 1U);
}

TEST(SourceCamera, AnEmptySourceEndsEvenWhenRepeated) {
  const CaptureClock clock;
  SourceCamera camera(counting({}, 1ms), {.repeat = true}, clock);
  open(camera);
  CameraFrame frame;
  EXPECT_EQ(camera.next(frame, 1s), FrameOutcome::ended);
}

}  // namespace
}  // namespace pelorus
