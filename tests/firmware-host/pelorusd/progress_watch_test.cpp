#include "firmware-host/pelorusd/progress_watch.h"

#include <gtest/gtest.h>

namespace pelorus {
namespace {

using std::chrono::milliseconds;

TEST(ProgressWatch, NamesThePartThatStandsStill) {
  ProgressWatch watch(milliseconds(1000));
  const ProgressWatch::Clock::time_point start{};
  for (int i = 0; i <= 30; ++i) {
    const auto now = start + milliseconds(100 * i);
    watch.look("vision", static_cast<std::uint64_t>(i), false, now);
    watch.look("camera", i < 10 ? static_cast<std::uint64_t>(i) : 9, false, now);
    EXPECT_EQ(watch.stuck(now), i <= 19 ? "" : "camera") << i;
  }
}

TEST(ProgressWatch, ASearchedCameraMayStandStillAndMovesAgainWhenFound) {
  ProgressWatch watch(milliseconds(1000));
  const ProgressWatch::Clock::time_point start{};
  for (int i = 0; i <= 30; ++i) watch.look("camera", 5, true, start + milliseconds(100 * i));
  EXPECT_EQ(watch.stuck(start + milliseconds(3000)), "");
  EXPECT_EQ(watch.stuck(start + milliseconds(4100)), "camera");
  watch.look("camera", 6, false, start + milliseconds(4200));
  EXPECT_EQ(watch.stuck(start + milliseconds(4200)), "");
}

TEST(ProgressWatch, APartWithALimitOfItsOwnIsGivenThatTime) {
  ProgressWatch watch(milliseconds(1000));
  const ProgressWatch::Clock::time_point start{};
  for (int i = 0; i <= 301; ++i) {
    const auto now = start + milliseconds(100 * i);
    watch.look("vision", static_cast<std::uint64_t>(i), false, now);
    watch.look("refinement", 7, false, now, milliseconds(30'000));
    EXPECT_EQ(watch.stuck(now), i <= 300 ? "" : "refinement") << i;
  }
}

}  // namespace
}  // namespace pelorus
