#include "services/recorder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <chrono>
#include <fstream>

#include "drivers/replay/dataset.h"
#include "firmware-host/runtime/calibration_writer.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr std::int64_t kFirstNs = 1'700'000'000'123'456'789;

StereoCalibration calibration() {
  StereoCalibration c;
  c.left = {kWidth, kHeight, 50, 51, 31, 24, LensKind::radtan, {-0.1, 0.01, 0.001, -0.002}};
  c.right = {kWidth, kHeight, 52, 53, 33, 23, LensKind::radtan, {-0.12, 0.02, 0.002, -0.001}};
  c.T_right_left.translation() = Eigen::Vector3d(-0.12, 0.001, 0.002);
  c.T_right_left.linear() = Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return c;
}

class RecorderTest : public testing::Test {
 protected:
  std::unique_ptr<Recorder> make(RecorderConfig config = {}) {
    config.folder = (folder_.path() / "recordings").string();
    return std::make_unique<Recorder>(config, FrameFormat{kWidth, kHeight, 1}, [](const std::filesystem::path& to) {
      return write_calibration(calibration(), CalibrationFormat::euroc, to);
    });
  }
  static bool reaches(const Recorder& recorder, RecorderState state) {
    for (int i = 0; i < 2000; ++i) {
      if (recorder.status().state == state) return true;
      std::this_thread::sleep_for(5ms);
    }
    return false;
  }
  static bool writes(const Recorder& recorder, std::uint64_t pairs) {
    for (int i = 0; i < 2000 && recorder.status().written < pairs; ++i) std::this_thread::sleep_for(5ms);
    return recorder.status().written == pairs;
  }
  static std::uint8_t pixel(int u, int v, int number, int side) {
    return static_cast<std::uint8_t>(u * 3 + v * 5 + number * 7 + side * 11);
  }
  static void offer(Recorder& recorder, int number) {
    Image views[2];
    for (int side = 0; side < 2; ++side) {
      views[side].resize(kWidth, kHeight);
      for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth; ++u) views[side].row(v)[u] = pixel(u, v, number, side);
    }
    recorder.offer(time_of(number), views[0].view(), views[1].view());
  }
  // A real, small disk where recordings go; false: not permitted.
  bool mount_disk(const std::string& size) {
    disk_ = (folder_.path() / "recordings").string();
    std::filesystem::create_directory(disk_);
    mounted_ = mount("none", disk_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
    return mounted_;
  }
  void TearDown() override {
    if (mounted_) umount2(disk_.c_str(), MNT_DETACH);
  }
  [[nodiscard]] std::vector<std::string> recordings() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "recordings"))
      if (entry.is_directory()) names.push_back(entry.path().filename().string());
    return names;
  }
  // Offers pairs for so long, whatever the recorder does.
  static void offer_for(Recorder& recorder, std::chrono::milliseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    for (int i = 0; std::chrono::steady_clock::now() < end; ++i) {
      offer(recorder, i);
      std::this_thread::sleep_for(1ms);
    }
  }
  static Timestamp time_of(int number) { return {kFirstNs + number * 50'000'000LL}; }

  test::TemporaryFolder folder_;
  std::string disk_;
  bool mounted_ = false;
};

// No file grows beyond so many bytes while this lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

TEST_F(RecorderTest, WhatItWritesReplayReads) {
  for (const char* format : {"png", "pgm"}) {
    auto recorder = make({.format = format, .min_free_gb = 0});
    EXPECT_TRUE(recorder->start());
    ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
    for (int i = 0; i < 10; ++i) offer(*recorder, i);
    ASSERT_TRUE(writes(*recorder, 10));
    EXPECT_TRUE(recorder->stop());
    ASSERT_TRUE(reaches(*recorder, RecorderState::off));
    EXPECT_EQ(recorder->status().dropped + recorder->status().failed, 0U);

    auto source = open_dataset(recorder->status().folder);
    ASSERT_TRUE(source.ok()) << source.error().message();
    EXPECT_EQ(source.value()->pair_count(), 10U);
    const StereoCalibration& read = source.value()->calibration();
    EXPECT_TRUE(read.T_right_left.isApprox(calibration().T_right_left, 1e-12));
    EXPECT_EQ(read.right.distortion, calibration().right.distortion);
    SourcePair pair;
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(source.value()->next(pair).value());
      EXPECT_EQ(pair.capture_time, time_of(i));
      for (int v = 0; v < kHeight; v += 3)
        for (int u = 0; u < kWidth; ++u) {
          ASSERT_EQ(pair.left.row(v)[u], pixel(u, v, i, 0));
          ASSERT_EQ(pair.right.row(v)[u], pixel(u, v, i, 1));
        }
    }
  }
}

TEST_F(RecorderTest, IgnoresPairsUntilStartedAndAfterStop) {
  auto recorder = make({.min_free_gb = 0});
  offer(*recorder, 0);
  recorder->start();
  ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
  offer(*recorder, 1);
  ASSERT_TRUE(writes(*recorder, 1));
  recorder->stop();
  ASSERT_TRUE(reaches(*recorder, RecorderState::off));
  offer(*recorder, 2);
  const std::string first = recorder->status().folder;
  EXPECT_TRUE(recorder->start());
  EXPECT_FALSE(recorder->start());
  ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
  EXPECT_NE(recorder->status().folder, first);
  EXPECT_EQ(recorder->status().written, 1U);
}

TEST_F(RecorderTest, WritesWhatWaitsWhenItIsDestroyed) {
  auto recorder = make({.at_start = true, .min_free_gb = 0, .queue_pairs = 32});
  ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
  for (int i = 0; i < 20; ++i) offer(*recorder, i);
  const std::string folder = recorder->status().folder;
  recorder.reset();
  const auto source = open_dataset(folder);
  ASSERT_TRUE(source.ok());
  EXPECT_EQ(source.value()->pair_count(), 20U);
}

TEST_F(RecorderTest, APairTheDiskIsTooSlowForIsDroppedAndCounted) {
  auto recorder = make({.at_start = true, .min_free_gb = 0, .queue_pairs = 2});
  ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
  constexpr std::uint64_t kOffered = 300;
  for (int i = 0; i < static_cast<int>(kOffered); ++i) offer(*recorder, i);
  for (int i = 0; i < 2000; ++i) {
    const RecorderStatus s = recorder->status();
    if (s.written + s.dropped == kOffered) break;
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_EQ(recorder->status().written + recorder->status().dropped, kOffered);
  EXPECT_GT(recorder->status().dropped, 0U);
}

TEST_F(RecorderTest, RecordsEveryNthPair) {
  auto recorder = make({.at_start = true, .min_free_gb = 0, .every = 3});
  ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
  for (int i = 0; i < 9; ++i) offer(*recorder, i);
  EXPECT_TRUE(writes(*recorder, 3));
}

TEST_F(RecorderTest, KeepsTheFreeSpaceOfTheDisk) {
  auto recorder = make({.at_start = true, .min_free_gb = 1e9});
  EXPECT_TRUE(reaches(*recorder, RecorderState::disk_full));
  EXPECT_NE(recorder->status().problem.find("GB free"), std::string::npos);
  recorder->stop();
  EXPECT_TRUE(reaches(*recorder, RecorderState::off));
}

// A disk that fills up and is emptied again.
TEST_F(RecorderTest, GoesOnByItselfWhenAFullDiskHasRoomAgain) {
  if (!mount_disk("4m")) GTEST_SKIP() << "mounting is not permitted";
  for (const double min_free_gb : {0.001, 0.0}) {
    auto recorder = make({.at_start = true, .format = "pgm", .min_free_gb = min_free_gb});
    ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
    for (int i = 0; i < 100'000 && recorder->status().state == RecorderState::recording; ++i) {
      offer(*recorder, i);
      std::this_thread::sleep_for(100us);
    }
    EXPECT_EQ(recorder->status().state, RecorderState::disk_full);
    const std::string full = recorder->status().folder;
    const auto source = open_dataset(full);
    ASSERT_TRUE(source.ok()) << source.error().message();
    EXPECT_EQ(source.value()->pair_count(), recorder->status().written);
    std::filesystem::remove_all(full);
    EXPECT_TRUE(reaches(*recorder, RecorderState::recording));
    EXPECT_NE(recorder->status().folder, full);
  }
}

TEST_F(RecorderTest, ADiskThatRunsFullIsOneRecordingAndIsToldAsFull) {
  if (!mount_disk("256k")) GTEST_SKIP() << "mounting is not permitted";
  auto recorder = make({.at_start = true, .format = "pgm", .min_free_gb = 0});
  ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
  offer_for(*recorder, 2500ms);
  const RecorderStatus status = recorder->status();
  EXPECT_EQ(status.state, RecorderState::disk_full) << summary(status);
  EXPECT_GT(status.written, 0U);
  EXPECT_EQ(recordings().size(), 1U);
  const auto source = open_dataset(status.folder);
  ASSERT_TRUE(source.ok()) << source.error().message();
  EXPECT_EQ(source.value()->pair_count(), status.written);
}

TEST_F(RecorderTest, AFullDiskIsToldAsFullAndGetsNoFolders) {
  if (!mount_disk("64k")) GTEST_SKIP() << "mounting is not permitted";
  std::ofstream(disk_ + "/filler") << std::string(100'000, 'x');
  auto recorder = make({.at_start = true, .min_free_gb = 0});
  ASSERT_TRUE(reaches(*recorder, RecorderState::disk_full));
  EXPECT_EQ(recordings().size(), 0U);
  EXPECT_EQ(summary(recorder->status()).rfind("disk full: ", 0), 0U) << summary(recorder->status());
}

TEST_F(RecorderTest, ACalibrationThatCannotBeWrittenLeavesNoFolder) {
  RecorderConfig config{.at_start = true, .min_free_gb = 0};
  config.folder = (folder_.path() / "recordings").string();
  const Recorder recorder(config, {kWidth, kHeight, 1}, [](const std::filesystem::path& to) -> Result<> {
    return Error{ErrorCode::io, to.string(), "cannot be written", ""};
  });
  ASSERT_TRUE(reaches(recorder, RecorderState::failed));
  EXPECT_EQ(recordings().size(), 0U);
}

// A file of the recording that cannot grow: its row is half written, in the list of the left camera only.
TEST_F(RecorderTest, APairThatCannotBeWrittenEndsTheRecordingAtItsLastWholeRow) {
  auto recorder = make({.at_start = true, .format = "pgm", .min_free_gb = 0, .queue_pairs = 200});
  ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
  const std::string folder = recorder->status().folder;
  {
    const FileSizeLimit limit(kWidth * kHeight + 200);  // less than the list of 100 pairs
    for (int i = 0; i < 100; ++i) offer(*recorder, i);
    ASSERT_TRUE(reaches(*recorder, RecorderState::failed));
  }
  const std::uint64_t written = recorder->status().written;
  EXPECT_GT(written, 10U);
  EXPECT_LT(written, 100U);
  EXPECT_EQ(recorder->status().failed, 1U);
  recorder->stop();
  ASSERT_TRUE(reaches(*recorder, RecorderState::off));
  EXPECT_EQ(recorder->status().dropped, 100 - written - 1) << "those that waited behind the one that failed";
  const auto source = open_dataset(folder);
  ASSERT_TRUE(source.ok()) << source.error().message();
  EXPECT_EQ(source.value()->pair_count(), written);
  SourcePair pair;
  for (std::uint64_t i = 0; i < written; ++i) ASSERT_TRUE(source.value()->next(pair).value());
  for (const char* camera : {"cam0", "cam1"}) {
    const std::filesystem::path data = std::filesystem::path(folder) / "mav0" / camera / "data";
    const auto pictures = std::distance(std::filesystem::directory_iterator(data), {});
    EXPECT_EQ(static_cast<std::uint64_t>(pictures), written) << camera << ": nothing is left of the pair that failed";
  }
}

// Each new recording fails at its first pair.
TEST_F(RecorderTest, AFailedWriteIsFollowedByAPauseAndAnEmptyRecordingLeavesNoFolder) {
  auto recorder = make({.at_start = true, .format = "pgm", .min_free_gb = 0});
  ASSERT_TRUE(reaches(*recorder, RecorderState::recording));
  const FileSizeLimit limit(1000);  // lists and calibration, no picture
  offer_for(*recorder, 2500ms);
  EXPECT_GE(recorder->status().failed, 1U);
  EXPECT_LE(recorder->status().failed, 4U) << "a try a second";
  EXPECT_TRUE(reaches(*recorder, RecorderState::failed));
  EXPECT_EQ(recorder->status().written, 0U);
  EXPECT_LE(recordings().size(), 1U) << "that of a try just begun";
}

TEST_F(RecorderTest, AFolderThatCannotBeIsAFailureWithItsReason) {
  std::ofstream(folder_.path() / "recordings") << "a file";
  auto recorder = make({.at_start = true, .min_free_gb = 0});
  EXPECT_TRUE(reaches(*recorder, RecorderState::failed));
  EXPECT_NE(recorder->status().problem.find("recordings"), std::string::npos);
}

}  // namespace
}  // namespace pelorus
