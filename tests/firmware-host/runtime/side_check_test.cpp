#include "firmware-host/runtime/side_check.h"

#include <gtest/gtest.h>

#include <utility>

#include "drivers/replay/dataset.h"
#include "tests/drivers/synthetic/small_dive.h"
#include "tests/support/real_data.h"

namespace pelorus {
namespace {

// A recording whose pictures of left and right have been exchanged, and nothing else.
class Exchanged : public StereoSource {
 public:
  explicit Exchanged(StereoSource& source) : source_(source) {}
  const StereoCalibration& calibration() const override { return source_.calibration(); }
  std::size_t pair_count() const override { return source_.pair_count(); }
  Result<bool> next(SourcePair& pair) override {
    Result<bool> more = source_.next(pair);
    std::swap(pair.left, pair.right);
    return more;
  }
  std::string description() const override { return source_.description(); }

 private:
  StereoSource& source_;
};

void expect_told_apart(const std::filesystem::path& path) {
  auto right_way = open_dataset(path);
  auto to_exchange = open_dataset(path);
  ASSERT_TRUE(right_way.ok() && to_exchange.ok());
  const Result<> good = check_sides(*right_way.value(), path.string());
  EXPECT_TRUE(good.ok()) << good.error().message();
  Exchanged exchanged(*to_exchange.value());
  const Result<> bad = check_sides(exchanged, path.string());
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().place, path.string());
  EXPECT_EQ(exit_code(bad.error().code), 3);
}

TEST(SideCheck, ASyntheticDiveIsToldApartFromItsExchange) {
  synthetic::SyntheticSource right_way(synthetic::small_dive());
  EXPECT_TRUE(check_sides(right_way, "dive").ok());
  synthetic::SyntheticSource dive(synthetic::small_dive());
  Exchanged exchanged(dive);
  const Result<> bad = check_sides(exchanged, "dive");
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.error().cure.find("exchange the two folders"), std::string::npos) << bad.error().message();
}

TEST(SideCheck, ARectifiedRecordingIsToldApart) {
  PELORUS_USE_REAL_DATA(path, "kitti_odometry/00_first21");
  expect_told_apart(path);
}

TEST(SideCheck, ARecordingWithMovingTrafficIsToldApart) {
  PELORUS_USE_REAL_DATA(path, "kitti_raw/2011_09_26_drive_0005_first60");
  expect_told_apart(path);
}

TEST(SideCheck, ARawRecordingIsToldApartThoughItsLensesDiffer) {
  PELORUS_USE_REAL_DATA(path, "euroc/V1_01_easy_first40");
  expect_told_apart(path);
}

TEST(SideCheck, DarknessAndFewMatchesAreUnclearAndNoError) {
  EXPECT_EQ(sides_of({0, 0}), Sides::unclear);
  EXPECT_EQ(sides_of({2, 39}), Sides::unclear) << "too few";
  EXPECT_EQ(sides_of({60, 200}), Sides::unclear) << "no clear majority";
  EXPECT_EQ(sides_of({10, 200}), Sides::exchanged);
  EXPECT_EQ(sides_of({200, 10}), Sides::as_given);
}

}  // namespace
}  // namespace pelorus
