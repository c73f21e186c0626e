#include "services/capture_watch.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace pelorus {
namespace {

constexpr std::int64_t kPeriod_ns = 50'000'000;
constexpr std::int64_t kStart_ns = 1'600'000'000'000'000'000;

// A camera of noise, 20 pairs a second, each there 8 ms after its exposure.
class Watched : public ::testing::Test {
 protected:
  Watched() { expose(left_), expose(right_); }
  void expose(Image& image) {
    image.resize(64, 48);
    for (int v = 0; v < 48; ++v) {
      for (int u = 0; u < 64; ++u) image.row(v)[u] = static_cast<std::uint8_t>(random_());
    }
  }
  // The next pair with its stamp `error_ns` off.
  CaptureVerdict next(std::int64_t error_ns = 0, std::int64_t extra_delay_ns = 0) {
    ++pair_;
    exposed_ = Timestamp{kStart_ns + pair_ * kPeriod_ns};
    const Timestamp arrival{exposed_.ns + 8'000'000 + extra_delay_ns};
    return watch_.look(Timestamp{exposed_.ns + error_ns}, arrival, left_.view(), right_.view());
  }
  CaptureVerdict next_fresh(std::int64_t error_ns = 0, std::int64_t extra_delay_ns = 0) {
    expose(left_), expose(right_);
    return next(error_ns, extra_delay_ns);
  }

  std::mt19937 random_{7};
  Image left_, right_;
  std::int64_t pair_ = 0;
  Timestamp exposed_;
  CaptureWatch watch_{CaptureWatchConfig{}};
};

TEST_F(Watched, LivePicturesAndTrueStampsPassUnchanged) {
  for (int i = 0; i < 20; ++i) {
    const CaptureVerdict verdict = next_fresh();
    EXPECT_EQ(verdict.capture_time, exposed_);
    EXPECT_FALSE(verdict.time_jumped || verdict.frozen);
    EXPECT_EQ(verdict.repeats, 0);
  }
}

TEST_F(Watched, ThirdRepetitionIsFrozenAndTheNextLivePictureIsNot) {
  next_fresh();
  EXPECT_EQ(next().repeats, 1);
  EXPECT_FALSE(next().frozen);
  const CaptureVerdict third = next();
  EXPECT_TRUE(third.frozen && third.froze);
  const CaptureVerdict fourth = next();
  EXPECT_TRUE(fourth.frozen);
  EXPECT_FALSE(fourth.froze) << "one spell is told once";
  EXPECT_EQ(next_fresh().repeats, 0);
}

TEST_F(Watched, OneFrozenCameraOfTheTwoIsEnough) {
  next_fresh();
  expose(left_);
  EXPECT_EQ(next().repeats, 1);
  expose(left_);
  EXPECT_EQ(next().repeats, 2);
}

TEST_F(Watched, OneGreyLevelOfDifferenceIsALivePicture) {
  next_fresh();
  left_.row(8)[17] ^= 1;
  right_.row(12)[40] ^= 1;
  EXPECT_EQ(next().repeats, 0);
}

TEST_F(Watched, StampsThatJumpAreReplacedAndTheTimeGoesOn) {
  for (const std::int64_t jump_ns :
       std::array<std::int64_t, 4>{5'000'000'000, -5'000'000'000, 200'000'000, -200'000'000}) {
    for (int i = 0; i < 5; ++i) next_fresh();
    const Timestamp before = exposed_;
    const CaptureVerdict at_jump = next_fresh(jump_ns);
    EXPECT_TRUE(at_jump.time_jumped) << jump_ns;
    EXPECT_NEAR(seconds(at_jump.capture_time - before), 0.05, 0.011) << jump_ns;
    Timestamp last = at_jump.capture_time;
    for (int i = 0; i < 5; ++i) {
      const CaptureVerdict after = next_fresh(jump_ns);
      EXPECT_NEAR(seconds(after.capture_time - last), 0.05, 0.011) << jump_ns;
      last = after.capture_time;
    }
    const CaptureVerdict back = next_fresh();
    EXPECT_EQ(back.capture_time, exposed_) << "true stamps are taken as they are again: " << jump_ns;
  }
}

TEST_F(Watched, AJumpIsToldOnceThereAndOnceBack) {
  for (int i = 0; i < 5; ++i) next_fresh();
  int told = 0;
  for (int i = 0; i < 10; ++i) told += next_fresh(3'000'000'000).time_jumped ? 1 : 0;
  EXPECT_EQ(told, 1);
  for (int i = 0; i < 10; ++i) told += next_fresh().time_jumped ? 1 : 0;
  EXPECT_EQ(told, 2);
}

TEST_F(Watched, ALateDeliveryIsNoJump) {
  for (int i = 0; i < 5; ++i) next_fresh();
  const CaptureVerdict late = next_fresh(0, 300'000'000);
  EXPECT_FALSE(late.time_jumped);
  EXPECT_EQ(late.capture_time, exposed_);
}

TEST_F(Watched, LightIsThatOfTheLeftPicture) {
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) left_.row(v)[u] = u < 32 ? 40 : 60;
  }
  const CaptureVerdict verdict = next();
  EXPECT_NEAR(verdict.mean_grey, 50, 1e-9);
  EXPECT_NEAR(verdict.contrast_grey, 10, 1e-9);
}

}  // namespace
}  // namespace pelorus
