#include "firmware-host/pelorusd/exchanged_sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/drivers/synthetic/small_dive.h"

namespace pelorus {
namespace {

using std::chrono::seconds;

struct Said {
  VisionState state;
  StateReason reason;
};

constexpr Said kLost{VisionState::lost, StateReason::few_points};
constexpr Said kExchanged{VisionState::calibration_fault, StateReason::exchanged_sides};
constexpr Said kTracking{VisionState::tracking, StateReason::none};
constexpr Said kRepeated{VisionState::degraded, StateReason::repeated_picture};
constexpr Said kNoPictures{VisionState::camera_fault, StateReason::no_pictures};

// The vision thread's side of it: what LOST pairs look like, and when they are asked for.
class ExchangedSidesBench : public ::testing::Test {
 protected:
  enum class Shown { exchanged, as_given, dark };

  ExchangedSidesBench() : rectifier_(Rectifier::create(source_.calibration(), "scene").value()) {
    source_.render(0, pair_);
  }
  void show(Shown what) {
    control_.lost_pair_wanted.store(false);
    SourcePair& shown = box_.draft();
    shown.left.assign(what == Shown::exchanged ? pair_.right.view() : pair_.left.view());
    shown.right.assign(what == Shown::exchanged ? pair_.left.view() : pair_.right.view());
    for (Image* image : {&shown.left, &shown.right}) {
      for (int v = 0; what == Shown::dark && v < image->height(); ++v) std::fill_n(image->row(v), image->width(), 3);
    }
    (void)box_.post();
  }
  [[nodiscard]] bool look(Said said) { return sides_.look(said.state, said.reason, now_); }
  // Looks each 50 ms of the next `time`, as the main thread does; each pair asked for is shown at once. How often the
  // pictures were said to be exchanged.
  int pass(seconds time, Shown what, Said said = kLost) {
    int told = 0;
    for (const auto end = now_ + time; now_ < end; now_ += std::chrono::milliseconds(50)) {
      told += look(said) ? 1 : 0;
      if (!control_.lost_pair_wanted.load()) continue;
      asked_.push_back(now_ - start_);
      show(what);
    }
    return told;
  }
  void find_exchanged() {
    EXPECT_EQ(pass(seconds(3), Shown::exchanged), 1);
    EXPECT_TRUE(control_.sides_exchanged.load());
    asked_.clear();
  }

  synthetic::SyntheticSource source_{synthetic::small_dive()};
  Rectifier rectifier_;
  SourcePair pair_;
  VisionControl control_;
  Mailbox<SourcePair> box_;
  ExchangedSides sides_{control_, box_, rectifier_};
  const ExchangedSides::Clock::time_point start_{};
  ExchangedSides::Clock::time_point now_ = start_;
  std::vector<ExchangedSides::Clock::duration> asked_;
};

TEST_F(ExchangedSidesBench, TwoPairsAreNeededToBelieveAndItIsToldOnceInATimeOfLost) {
  EXPECT_EQ(pass(seconds(2), Shown::exchanged), 0);
  EXPECT_EQ(asked_.size(), 1U);
  EXPECT_FALSE(control_.sides_exchanged.load());
  EXPECT_EQ(pass(seconds(1), Shown::exchanged), 1);
  EXPECT_EQ(asked_.size(), 2U);
  EXPECT_TRUE(control_.sides_exchanged.load());
  EXPECT_EQ(pass(seconds(300), Shown::exchanged, kExchanged), 0);
  EXPECT_EQ(asked_.size(), 2U + 300 / 60) << "known, and asked about once a minute";
  EXPECT_TRUE(control_.sides_exchanged.load());
  EXPECT_EQ(pass(seconds(300), Shown::dark, kExchanged), 0) << "the lights are off: no other word";
  EXPECT_TRUE(control_.sides_exchanged.load());
  pass(seconds(1), Shown::exchanged, kNoPictures);
  EXPECT_FALSE(control_.sides_exchanged.load());
  EXPECT_EQ(pass(seconds(10), Shown::exchanged), 1) << "LOST again";
}

TEST_F(ExchangedSidesBench, APoseEndsIt) {
  find_exchanged();
  EXPECT_FALSE(look(kTracking));
  EXPECT_FALSE(control_.sides_exchanged.load());
}

// Both were false, or the cables were put right while nothing was found.
TEST_F(ExchangedSidesBench, APairThatMatchesAsGivenEndsItAndItCanBeFoundAgain) {
  find_exchanged();
  EXPECT_EQ(pass(seconds(61), Shown::as_given, kExchanged), 0);
  EXPECT_FALSE(control_.sides_exchanged.load());
  EXPECT_EQ(pass(seconds(58), Shown::exchanged), 0);
  EXPECT_EQ(asked_.size(), 1U) << "the next is asked for after a minute";
  EXPECT_EQ(pass(seconds(5), Shown::exchanged), 1);
  EXPECT_TRUE(control_.sides_exchanged.load());
}

// The driver gave one picture twice: the state would flicker between LOST and CALIBRATION_FAULT.
TEST_F(ExchangedSidesBench, ARepeatedPictureChangesNothing) {
  find_exchanged();
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(look(kRepeated));
    EXPECT_TRUE(control_.sides_exchanged.load());
    EXPECT_EQ(pass(seconds(2), Shown::exchanged, kExchanged), 0);
  }
  EXPECT_EQ(asked_.size(), 1U) << "in 100 s";
}

TEST_F(ExchangedSidesBench, OnePairThatMatchesAsGivenIsAskedAboutRarely) {
  EXPECT_EQ(pass(seconds(2), Shown::exchanged), 0);
  show(Shown::as_given);
  EXPECT_EQ(pass(seconds(300), Shown::as_given), 0);
  EXPECT_EQ(asked_.size(), 1U + 4U);
  EXPECT_FALSE(control_.sides_exchanged.load());
}

TEST_F(ExchangedSidesBench, InTheDarkItIsAskedEverMoreRarelyAndNeverGivenUp) {
  EXPECT_EQ(pass(seconds(1), Shown::dark, kTracking), 0);
  EXPECT_TRUE(asked_.empty());
  EXPECT_EQ(pass(seconds(3600), Shown::dark), 0);
  const std::vector<int> first = {2, 3, 5, 9, 17, 33, 65, 125, 185};  // one second of TRACKING, one of patience
  ASSERT_GE(asked_.size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(asked_[i], seconds(first[i])) << i;
  EXPECT_NEAR(static_cast<double>(asked_.size()), 6 + 3600 / 60, 2);
  EXPECT_EQ(pass(seconds(62), Shown::exchanged), 1) << "the light goes on: the second pair is not waited for";
}

TEST_F(ExchangedSidesBench, WhatAnEarlierTimeWasShownSaysNothingOfTheNext) {
  EXPECT_EQ(pass(seconds(2), Shown::exchanged), 0);
  show(Shown::as_given);
  EXPECT_FALSE(look(kTracking));
  EXPECT_EQ(pass(seconds(10), Shown::exchanged), 1);
}

}  // namespace
}  // namespace pelorus
