#include "firmware-host/pelorus/replay/replay_run.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware-host/pelorus/results/incomplete_mark.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::read_text;
using test::TemporaryFolder;

// Rectified grey pairs, `interval_ns` apart; one pair may be missing, one may fail.
class FakeSource : public StereoSource {
 public:
  explicit FakeSource(std::uint64_t pairs) : pairs_(pairs) {
    CameraIntrinsics camera;
    camera.width = 64;
    camera.height = 48;
    camera.fx_px = camera.fy_px = 50;
    camera.cx_px = 31.5;
    camera.cy_px = 23.5;
    calibration_.left = calibration_.right = camera;
    calibration_.T_right_left.translation().x() = -0.1;
    calibration_.rectified = true;
  }
  const StereoCalibration& calibration() const override { return calibration_; }
  std::size_t pair_count() const override { return pairs_; }
  Result<bool> next(SourcePair& pair) override {
    if (next_ == missing) ++next_;
    if (next_ >= failing && next_ - failing < failures) {
      ++next_;
      return Error{ErrorCode::bad_input, "frame " + std::to_string(next_ - 1), "truncated image", ""};
    }
    if (next_ >= pairs_) return false;
    pair.seq = next_;
    pair.capture_time = Timestamp{static_cast<std::int64_t>(next_) * interval_ns};
    pair.left.resize(64, 48);
    pair.right.resize(64, 48);
    ++next_;
    return true;
  }
  MissingPairs missing_pairs() const override {
    const bool passed = next_ > missing;
    return {passed ? 1U : 0U, Timestamp{passed ? static_cast<std::int64_t>(missing) * interval_ns : 0}};
  }
  std::string description() const override { return "fake"; }

  std::uint64_t failing = ~0ULL;
  std::uint64_t failures = 1000;
  std::uint64_t missing = ~0ULL;
  std::int64_t interval_ns = 1000;

 private:
  std::uint64_t pairs_;
  std::uint64_t next_ = 0;
  StereoCalibration calibration_;
};

ReplayOptions options_for(const TemporaryFolder& folder) {
  ReplayOptions options;
  options.out_folder = folder.path();
  return options;
}

long frames_written(const TemporaryFolder& folder) {
  const std::string text = read_text(folder.path() / "frames.csv");
  return std::count(text.begin(), text.end(), '\n') - 1;
}

TEST(RunReplay, SteppedModeTakesEveryPair) {
  const TemporaryFolder folder;
  FakeSource source(5);
  const Result<ReplaySummary> summary = run_replay(source, options_for(folder));
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary.value().frames, 5U);
  EXPECT_EQ(summary.value().lost.dropped, 0U);
  EXPECT_EQ(frames_written(folder), 5);
}

TEST(RunReplay, SourceErrorMidwayKeepsWhatWasProcessedAndIsReported) {
  const TemporaryFolder folder;
  FakeSource source(5);
  source.failing = 2;
  const Result<ReplaySummary> summary = run_replay(source, options_for(folder));
  ASSERT_TRUE(summary.ok());
  ASSERT_TRUE(summary.value().failure.has_value());
  EXPECT_EQ(summary.value().failure->detail, "truncated image");
  EXPECT_EQ(frames_written(folder), 2);
}

TEST(RunReplay, FewDamagedPairsAreToldOfAndBridged) {
  const TemporaryFolder folder;
  FakeSource source(10);
  source.failing = 4;
  source.failures = 3;
  ReplayOptions options = options_for(folder);
  int warnings = 0;
  options.warn = [&warnings](const Error&) { ++warnings; };
  const Result<ReplaySummary> summary = run_replay(source, options);
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary.value().frames, 7U);
  EXPECT_EQ(summary.value().lost.unreadable, 3U);
  EXPECT_EQ(summary.value().lost.missing, 0U) << "not counted twice";
  EXPECT_EQ(warnings, 3);
  ASSERT_TRUE(summary.value().failure.has_value());
  EXPECT_EQ(summary.value().failure->place, "frame 4") << "the first one names the cause";
}

// Before the first readable pair nothing has to be bridged, and no gap in seq is left.
TEST(RunReplay, DamagedPairsAtTheStartAreSkippedHoweverMany) {
  const TemporaryFolder folder;
  FakeSource source(12);
  source.failing = 0;
  source.failures = 6;
  source.missing = 9;
  const Result<ReplaySummary> summary = run_replay(source, options_for(folder));
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary.value().frames, 5U);
  EXPECT_EQ(summary.value().lost.unreadable, 6U);
  EXPECT_EQ(summary.value().lost.missing, 1U) << "the pair that was never recorded is still told of";
  EXPECT_FALSE(summary.value().ended_early);
  ASSERT_TRUE(summary.value().failure.has_value());
  EXPECT_EQ(summary.value().failure->place, "frame 0");
}

TEST(RunReplay, FourDamagedPairsInARowEndTheRun) {
  const TemporaryFolder folder;
  FakeSource source(10);
  source.failing = 4;
  source.failures = 4;
  const Result<ReplaySummary> summary = run_replay(source, options_for(folder));
  ASSERT_TRUE(summary.ok());
  EXPECT_TRUE(summary.value().failure.has_value());
  EXPECT_TRUE(summary.value().ended_early);
  EXPECT_TRUE(summary.value().broke_off);
  EXPECT_EQ(frames_written(folder), 4);
  EXPECT_NE(incomplete_reason(folder.path()).value_or("").find("broke off: frame 7"), std::string::npos)
      << incomplete_reason(folder.path()).value_or("no mark");
}

TEST(RunReplay, StopRequestEndsTheRunWithValidFiles) {
  const TemporaryFolder folder;
  FakeSource source(5);
  ReplayOptions options = options_for(folder);
  int asked = 0;
  options.stop = [&asked] { return ++asked > 3; };
  const Result<ReplaySummary> summary = run_replay(source, options);
  ASSERT_TRUE(summary.ok());
  EXPECT_TRUE(summary.value().interrupted);
  EXPECT_EQ(frames_written(folder), 3);
  EXPECT_EQ(incomplete_reason(folder.path()), "interrupted");
}

TEST(RunReplay, FrameLimitIsNotAnInterruption) {
  const TemporaryFolder folder;
  FakeSource source(5);
  ReplayOptions options = options_for(folder);
  options.max_frames = 2;
  const Result<ReplaySummary> summary = run_replay(source, options);
  ASSERT_TRUE(summary.ok());
  EXPECT_FALSE(summary.value().interrupted);
  EXPECT_EQ(summary.value().frames, 2U);
}

TEST(RunReplay, PairMissingInTheRecordingIsCounted) {
  const TemporaryFolder folder;
  FakeSource source(5);
  source.missing = 3;
  const Result<ReplaySummary> summary = run_replay(source, options_for(folder));
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary.value().frames, 4U);
  EXPECT_EQ(summary.value().lost.missing, 1U);
  EXPECT_EQ(summary.value().first_missing.ns, 3000);
  EXPECT_TRUE(is_incomplete(summary.value()));
  EXPECT_FALSE(incomplete_reason(folder.path()).has_value()) << "the run itself is whole";
}

// Pairs one nanosecond apart are all late at once: the first starts the clock, the last is the newest.
TEST(RunReplay, RealTimeModeLetsTheNewestPairWinAndCountsTheDropped) {
  const TemporaryFolder folder;
  FakeSource source(6);
  source.interval_ns = 1;
  ReplayOptions options = options_for(folder);
  options.realtime = true;
  const Result<ReplaySummary> summary = run_replay(source, options);
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary.value().frames, 2U);
  EXPECT_EQ(summary.value().lost.dropped, 4U);
  EXPECT_EQ(summary.value().lost.missing, 0U);
  EXPECT_FALSE(is_incomplete(summary.value())) << "being late is no fault of the recording";
}

TEST(RunReplay, OverlayWritesAPictureOfEveryNthFrame) {
  const TemporaryFolder folder;
  FakeSource source(5);
  ReplayOptions options = options_for(folder);
  options.overlay_every = 2;
  ASSERT_TRUE(run_replay(source, options).ok());
  for (const char* name : {"000000.png", "000002.png", "000004.png"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "overlay" / name)) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "overlay" / "000001.png"));
}

TEST(RunReplay, SameInputGivesTheSameBytes) {
  const TemporaryFolder once;
  const TemporaryFolder again;
  for (const TemporaryFolder* folder : {&once, &again}) {
    FakeSource source(5);
    ASSERT_TRUE(run_replay(source, options_for(*folder)).ok());
  }
  for (const char* name : {"camera.tum", "objects.csv", "frames.csv"}) {
    EXPECT_EQ(read_text(once.path() / name), read_text(again.path() / name)) << name;
  }
}

TEST(RunReplay, MissingOutputFolderIsAnErrorBeforeAnyWork) {
  FakeSource source(1);
  ReplayOptions options;
  options.out_folder = "/nonexistent/folder";
  const Result<ReplaySummary> summary = run_replay(source, options);
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.error().code, ErrorCode::io);
}

}  // namespace
}  // namespace pelorus
