#include "drivers/replay/dataset.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "tests/drivers/replay/recording_fixture.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

using Dataset = RecordingFixture;

TEST_F(Dataset, ReadsEurocInOrderWithNanoseconds) {
  const fs::path root = euroc();
  for (const fs::path& path : {root, root / "mav0"}) {
    const auto source = open(path);
    ASSERT_NE(source, nullptr);
    EXPECT_EQ(source->pair_count(), 8u);
    SourcePair pair;
    for (int i = 0; i < kPairs; ++i) {
      ASSERT_TRUE(source->next(pair).value());
      EXPECT_EQ(pair.seq, static_cast<std::uint64_t>(i));
      EXPECT_EQ(pair.capture_time.ns, time_ns(i));
      EXPECT_EQ(pair.left.row(0)[0], 20 * i);
      EXPECT_EQ(pair.right.row(0)[0], 20 * i + 1);
      EXPECT_EQ(pair.left.width(), kWidth);
    }
    EXPECT_FALSE(source->next(pair).value());
    EXPECT_NEAR(source->calibration().T_right_left.translation().x(), -0.11, 1e-9);
    EXPECT_EQ(source->calibration().left.lens, LensKind::radtan);
    EXPECT_FALSE(source->calibration().rectified);
  }
}

TEST_F(Dataset, ReadsEurocWithoutListFromTheNames) {
  const fs::path root = euroc();
  fs::remove(root / "mav0/cam0/data.csv");
  fs::remove(root / "mav0/cam1/data.csv");
  SourcePair pair;
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->pair_count(), 8u);
  ASSERT_TRUE(source->next(pair).value());
  EXPECT_EQ(pair.capture_time.ns, time_ns(0));
}

TEST_F(Dataset, ReadsKittiOdometry) {
  const auto source = open(kitti_odometry());
  ASSERT_NE(source, nullptr);
  SourcePair pair;
  ASSERT_TRUE(source->next(pair).value());
  ASSERT_TRUE(source->next(pair).value());
  EXPECT_EQ(pair.capture_time.ns, 100'000'000);
  EXPECT_EQ(pair.right.row(0)[0], 21);
  EXPECT_TRUE(source->calibration().rectified);
  EXPECT_NEAR(source->calibration().T_right_left.translation().x(), -0.5, 1e-12);
  EXPECT_EQ(source->calibration().left.width, kWidth);  // calib.txt has no size: the images give it
}

TEST_F(Dataset, ReadsKittiRawWithTheCalibrationOfTheDay) {
  const auto source = open(kitti_raw());
  ASSERT_NE(source, nullptr);
  SourcePair pair;
  ASSERT_TRUE(source->next(pair).value());
  EXPECT_EQ(pair.capture_time.ns, 1'317'042'272'351'950'336);
  EXPECT_NEAR(source->calibration().T_right_left.translation().x(), -0.5, 1e-12);
  EXPECT_EQ(all_seqs(*source).back(), 7u);
}

TEST_F(Dataset, AMissingImageOnEitherSideIsAGapInSeq) {
  const fs::path root = euroc();
  fs::remove(root / "mav0/cam1/data" / png(3));
  fs::remove(root / "mav0/cam0/data" / png(5));
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->pair_count(), 6u);
  EXPECT_EQ(all_seqs(*source), (std::vector<std::uint64_t>{0, 1, 2, 4, 6, 7}));
  EXPECT_NE(source->description().find("lost: 2 pairs (1 without left image, 1 without right image"), std::string::npos)
      << source->description();
  EXPECT_NE(source->description().find("the first at " + std::to_string(time_ns(3)) + " ns"), std::string::npos)
      << source->description();
}

// Losses at the start and at the end leave no gap between two pairs, and are losses all the same.
TEST_F(Dataset, MissingPairsAreCountedAsFarAsTheReadingIs) {
  const fs::path root = euroc();
  for (const int lost : {0, 4}) fs::remove(root / "mav0/cam1/data" / png(lost));
  fs::remove(root / "mav0/cam0/data" / png(kPairs - 1));
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  std::vector<std::uint64_t> counts{source->missing_pairs().count};
  SourcePair pair;
  while (source->next(pair).value()) counts.push_back(source->missing_pairs().count);
  EXPECT_EQ(counts, (std::vector<std::uint64_t>{0, 1, 1, 1, 2, 3})) << "before the first pair, then after each";
  EXPECT_EQ(source->missing_pairs().first.ns, time_ns(0));
}

TEST_F(Dataset, ALineMissingInBothListsIsAGapInSeqToo) {
  const fs::path root = euroc();
  for (const char* camera : {"mav0/cam0", "mav0/cam1"}) {
    std::string csv;
    for (int i = 0; i < kPairs; ++i)
      if (i != 2 && i != 3) csv += std::to_string(time_ns(i)) + "," + png(i) + "\n";
    write(root / camera / "data.csv", csv);
  }
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(all_seqs(*source), (std::vector<std::uint64_t>{0, 1, 4, 5, 6, 7}));
  EXPECT_NE(source->description().find("2 without both"), std::string::npos) << source->description();
  EXPECT_EQ(source->missing_pairs().count, 2u);
  EXPECT_NEAR(static_cast<double>(source->missing_pairs().first.ns - time_ns(2)), 0, 1e6) << "no image tells it";
}

TEST_F(Dataset, AMissingKittiImageIsAGapInSeq) {
  const fs::path root = kitti_odometry();
  fs::remove(root / "image_1/000004.png");
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(all_seqs(*source), (std::vector<std::uint64_t>{0, 1, 2, 3, 5, 6, 7}));
}

// The list of times tells how many pairs there should be, also where no image is before or after.
TEST_F(Dataset, MissingPairsAtTheEndsOfAListAreCounted) {
  const auto odometry_png = [](int i) { return "00000" + std::to_string(i) + ".png"; };
  const auto raw_png = [](int i) { return "000000000" + std::to_string(i) + ".png"; };
  struct Layout {
    fs::path left, right;
    std::function<std::string(int)> name;
    fs::path root;
  };
  const fs::path odometry = kitti_odometry(), raw = kitti_raw(), rooms = euroc();
  for (const Layout& layout : {Layout{odometry / "image_0", odometry / "image_1", odometry_png, odometry},
                               Layout{raw / "image_00/data", raw / "image_01/data", raw_png, raw},
                               Layout{rooms / "mav0/cam0/data", rooms / "mav0/cam1/data", png, rooms}}) {
    for (const int both : {0, 1, kPairs - 1}) {
      fs::remove(layout.left / layout.name(both));
      fs::remove(layout.right / layout.name(both));
    }
    fs::remove(layout.right / layout.name(2));
    fs::remove(layout.left / layout.name(kPairs - 2));
    const auto source = open(layout.root);
    ASSERT_NE(source, nullptr);
    SourcePair pair;
    ASSERT_TRUE(source->next(pair).value());
    const Timestamp fourth = pair.capture_time;
    EXPECT_EQ(pair.seq, 3u) << layout.root;
    EXPECT_EQ(source->missing_pairs().count, 3u) << layout.root;
    EXPECT_EQ(all_seqs(*source), (std::vector<std::uint64_t>{4, 5})) << layout.root;
    EXPECT_EQ(source->missing_pairs().count, 5u) << layout.root;
    EXPECT_LT(source->missing_pairs().first, fourth) << layout.root;
    EXPECT_NE(source->description().find("(1 without left image, 1 without right image, 3 without both)"),
              std::string::npos)
        << source->description();
  }
}

TEST_F(Dataset, AListThatIsLongerThanItsRecordingIsToldWithItsCure) {
  const auto remark = [](const fs::path& root) {
    const auto source = open(root);
    return source == nullptr ? "" : source->description();
  };
  const std::string cure = " are not there; if the recording was cut on purpose, cut that list too";
  const fs::path rooms = euroc(), odometry = kitti_odometry();
  EXPECT_EQ(remark(rooms).find(cure), std::string::npos) << "whole";
  fs::remove(rooms / "mav0/cam0/data" / png(3));
  fs::remove(rooms / "mav0/cam0/data" / png(kPairs - 1));
  EXPECT_EQ(remark(rooms).find(cure), std::string::npos) << "lost, not cut: the right image is there";
  fs::remove(rooms / "mav0/cam1/data" / png(kPairs - 1));
  EXPECT_NE(remark(rooms).find("the pairs at the end of cam0/data.csv and cam1/data.csv" + cure), std::string::npos)
      << remark(rooms);
  fs::remove(rooms / "mav0/cam1/data.csv");
  EXPECT_NE(remark(rooms).find("the pairs at the end of cam0/data.csv" + cure), std::string::npos) << remark(rooms);
  fs::remove(rooms / "mav0/cam0/data.csv");
  EXPECT_EQ(remark(rooms).find(cure), std::string::npos) << "no list";
  EXPECT_EQ(remark(odometry).find(cure), std::string::npos) << "whole";
  for (const char* side : {"image_0", "image_1"}) fs::remove(odometry / side / "000007.png");
  EXPECT_NE(remark(odometry).find("the pairs at the end of times.txt" + cure), std::string::npos) << remark(odometry);
}

TEST_F(Dataset, ALongGapIsReported) {
  const fs::path root = euroc();
  for (int i = 2; i < 6; ++i) fs::remove(root / "mav0/cam1/data" / png(i));
  const auto source = open(root);
  ASSERT_NE(source, nullptr);
  EXPECT_NE(source->description().find("warning: 4 pairs in a row are lost after " + std::to_string(time_ns(1))),
            std::string::npos)
      << source->description();
}

TEST_F(Dataset, DuplicateAndUnsortedTimesNameTheirLine) {
  const fs::path root = euroc();
  const fs::path csv = root / "mav0/cam0/data.csv";
  write(csv, "#h\n" + std::to_string(time_ns(0)) + ",a.png\n" + std::to_string(time_ns(0)) + ",b.png\n");
  expect_error(root, "cam0/data.csv:3", "appears twice");
  write(csv, "#h\n" + std::to_string(time_ns(1)) + ",a.png\n" + std::to_string(time_ns(0)) + ",b.png\n");
  expect_error(root, "cam0/data.csv:3", "earlier than the one before");
  write(csv, "#h\nyesterday,a.png\n");
  expect_error(root, "cam0/data.csv:2", "does not start with a time stamp");
  const fs::path odometry = kitti_odometry();
  write(odometry / "times.txt", "0\n0.1\n0.2\n0.15\n0.4\n0.5\n0.6\n0.7\n");
  expect_error(odometry, "times.txt:4", "earlier than the one before");
}

TEST_F(Dataset, TheCureOfAWrongTimeKeepsItsLineWhereTheLineCounts) {
  const fs::path odometry = kitti_odometry();
  for (const char* times : {"0\n0.1\n0.1\n0.3\n0.4\n0.5\n0.6\n0.7\n", "0\n0.2\n0.1\n0.3\n0.4\n0.5\n0.6\n0.7\n"}) {
    write(odometry / "times.txt", times);
    const auto source = open_dataset(odometry);
    ASSERT_FALSE(source.ok());
    EXPECT_NE(source.error().place.find("times.txt:3"), std::string::npos) << source.error().message();
    EXPECT_NE(source.error().cure.find("correct the time"), std::string::npos) << source.error().message();
    EXPECT_EQ(source.error().cure.find("remove"), std::string::npos) << source.error().message();
  }
}

TEST_F(Dataset, ASinglePairIsNotCalledPairs) {
  const fs::path odometry = kitti_odometry();
  for (int i = 1; i < kPairs; ++i) fs::remove(odometry / "image_0" / ("00000" + std::to_string(i) + ".png"));
  const auto source = open(odometry);
  ASSERT_NE(source, nullptr);
  EXPECT_NE(source->description().find(": 1 pair"), std::string::npos) << source->description();
  EXPECT_EQ(source->description().find("1 pairs"), std::string::npos) << source->description();
}

TEST_F(Dataset, FewerTimesThanImagesIsAnError) {
  const fs::path odometry = kitti_odometry();
  write(odometry / "times.txt", "0\n0.1\n0.2\n");
  expect_error(odometry, "image_0", "times.txt ends at line 3");
  const fs::path raw = kitti_raw();
  write(raw / "image_00/timestamps.txt", "2011-09-26 13:04:32.351950336\n2011-09-26 25:04:32\n");
  expect_error(raw, "timestamps.txt:2", "is not a time");
}

TEST_F(Dataset, CamerasThatNeverCoincideAreAnError) {
  const fs::path root = euroc();
  std::string csv;
  for (int i = 0; i < kPairs; ++i) csv += std::to_string(time_ns(i) + 20'000'000) + "," + png(i) + "\n";
  write(root / "mav0/cam1/data.csv", csv);
  expect_error(root, "mav0", "has a right one");
}

TEST_F(Dataset, ACameraWithoutImagesIsAnError) {
  const fs::path root = euroc();
  fs::remove_all(root / "mav0/cam1/data");
  expect_error(root, "cam1", "none of the 8 listed images is there");
  fs::remove_all(root / "mav0/cam1");
  expect_error(root, "mav0", "has cam0 but no cam1");
}

TEST_F(Dataset, FoldersThatAreNoRecordingAreErrors) {
  expect_error(folder_ / "absent", "absent", "does not exist");
  fs::create_directories(folder_ / "hollow");
  expect_error(folder_ / "hollow", "hollow", "empty");
  write(folder_ / "other/readme.txt", "x");
  expect_error(folder_ / "other", "other", "no known data set");
  expect_error(folder_ / "other/readme.txt", "readme.txt", "is neither a folder nor an LCM log");
  EXPECT_NE(open_dataset(folder_ / "other").error().message().find("LCM log"), std::string::npos);
}

TEST_F(Dataset, ACalibrationThatCannotBeNamesItsFile) {
  const fs::path root = euroc();
  const fs::path sensor = root / "mav0/cam1/sensor.yaml";
  write(sensor, sensor_yaml(T_BS_at(0.0)));
  expect_error(root, "cam1/sensor.yaml", "no baseline");
  write(sensor, sensor_yaml(T_BS_at(-0.11)));
  expect_error(root, "cam1/sensor.yaml", "negative baseline");
  write(sensor, sensor_yaml("1, 0, 0, 0.1"));
  expect_error(root, "cam1/sensor.yaml:4", "'T_BS' has 4 numbers instead of 16");
  write(sensor, sensor_yaml(T_BS_at(0.11), "omni"));
  expect_error(root, "cam1/sensor.yaml:11", "unknown lens model 'omni'");
  write(sensor, "a: [1, 2\nb: 3\n");
  expect_error(root, "cam1/sensor.yaml", "not valid YAML");
  fs::remove(sensor);
  expect_error(root, "cam1/sensor.yaml", "cannot be read");
  const fs::path odometry = kitti_odometry();
  write(odometry / "calib.txt", "P0: 60 0 31.5 0 0 60 23.5 0 0 0 1 0\nP1: 60 0 31.5 30 0 60 23.5 0 0 0 1 0\n");
  expect_error(odometry, "calib.txt:2", "negative baseline");
  write(odometry / "calib.txt", "P0: 60 0 31.5 0 0 60 23.5 0 0 0 1 0\n");
  expect_error(odometry, "calib.txt", "'P1' is missing");
}

TEST_F(Dataset, WithoutACalibrationTheCureNamesTheOptionForAnother) {
  const fs::path odometry = kitti_odometry(), raw = kitti_raw(), rooms = euroc();
  fs::remove(odometry / "calib.txt");
  fs::remove(raw.parent_path() / "calib_cam_to_cam.txt");
  fs::remove(rooms / "mav0/cam1/sensor.yaml");
  for (const fs::path& recording : {odometry, raw, rooms}) {
    const auto source = open_dataset(recording);
    ASSERT_FALSE(source.ok());
    EXPECT_NE(source.error().cure.find("--calib FILE"), std::string::npos) << source.error().message();
  }
}

TEST_F(Dataset, TheUsersCalibrationReplacesABrokenOneAndKeepsTheBody) {
  const fs::path root = euroc();
  LoadedCalibration given{open(root)->calibration(), "mine.yaml", {}};
  given.calibration.T_right_left.translation().x() = -0.2;
  given.calibration.body_known = false;
  write(root / "mav0/cam0/sensor.yaml", sensor_yaml("1, 0, 0, 0.3, 0, 1, 0, 0.4, 0, 0, 1, 0, 0, 0, 0, 1"));
  auto source = open_dataset(root, given);
  ASSERT_TRUE(source.ok()) << source.error().message();
  EXPECT_NE(source.value()->description().find("mine.yaml"), std::string::npos);
  EXPECT_EQ(source.value()->calibration().T_right_left.translation().x(), -0.2);
  fs::remove(root / "mav0/cam0/sensor.yaml");
  EXPECT_TRUE(open_dataset(root, given).ok());
}

}  // namespace
}  // namespace pelorus
