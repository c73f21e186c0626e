// The data sets the project is measured on, read whole.

#include <gtest/gtest.h>

#include "drivers/replay/dataset.h"
#include "tests/support/real_data.h"

namespace pelorus {
namespace {

struct Facts {
  std::size_t pairs = 0;
  int width = 0;
  int height = 0;
  double baseline_m = 0;
  double duration_s = 0;
};

void expect_facts(const std::filesystem::path& path, const Facts& facts) {
  auto opened = open_dataset(path);
  ASSERT_TRUE(opened.ok()) << opened.error().message();
  StereoSource& source = *opened.value();
  EXPECT_EQ(source.pair_count(), facts.pairs);
  EXPECT_NEAR(source.calibration().T_right_left.translation().norm(), facts.baseline_m, 1e-3);
  SourcePair pair;
  Timestamp first;
  std::size_t read = 0;
  for (;; ++read) {
    const auto more = source.next(pair);
    ASSERT_TRUE(more.ok()) << more.error().message();
    if (!more.value()) break;
    EXPECT_EQ(pair.seq, read);  // nothing is missing in these recordings
    EXPECT_EQ(pair.left.width(), facts.width);
    EXPECT_EQ(pair.right.height(), facts.height);
    if (read == 0) first = pair.capture_time;
  }
  EXPECT_EQ(read, facts.pairs);
  EXPECT_NEAR(seconds(pair.capture_time - first), facts.duration_s, 0.01);
}

TEST(RecordedData, EurocIsReadWhole) {
  PELORUS_USE_REAL_DATA(path, "euroc/V1_01_easy_first40");
  expect_facts(path, {40, 752, 480, 0.110, 1.95});
}

TEST(RecordedData, KittiOdometryIsReadWhole) {
  PELORUS_USE_REAL_DATA(path, "kitti_odometry/06_first41");
  expect_facts(path, {41, 1226, 370, 0.537, 4.148});
}

TEST(RecordedData, KittiRawIsReadWhole) {
  PELORUS_USE_REAL_DATA(path, "kitti_raw/2011_09_26_drive_0005_first60");
  expect_facts(path, {60, 1242, 375, 0.537, 6.1});
}

}  // namespace
}  // namespace pelorus
