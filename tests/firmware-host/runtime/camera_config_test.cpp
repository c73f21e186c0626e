#include "firmware-host/runtime/camera_config.h"

#include <gtest/gtest.h>

namespace pelorus {
namespace {

std::string problem_of(const std::string& driver, const CameraConfig& config) {
  const CaptureClock clock;
  const auto cameras = make_cameras(driver, config, clock);
  return cameras ? "none" : cameras.error().message();
}

// The settings are good for all that opens no camera: replay, top, ablate, doctor. pelorusd needs the driver.
TEST(CameraConfig, OnlyWhoOpensCamerasMissesADriverThatIsNotBuiltIn) {
  CameraConfig config;
  config.left = "192.0.2.1";
  config.right = "192.0.2.2";
  for (const std::string driver : {"aravis", "v4l2"}) {
    EXPECT_TRUE(camera_problems(driver, config).empty()) << driver;
    const bool missing = missing_driver(driver).has_value();
    EXPECT_EQ(problem_of(driver, config).find("is not built in") != std::string::npos, missing) << driver;
  }
  EXPECT_FALSE(missing_driver("replay"));
}

TEST(CameraConfig, MakesACameraForEachDeviceWithoutOpeningIt) {
  if (missing_driver("aravis")) GTEST_SKIP() << missing_driver("aravis")->what;
  CameraConfig config;
  config.left = "192.0.2.1";
  config.right = "192.0.2.2";
  const CaptureClock clock;
  const auto cameras = make_cameras("aravis", config, clock);
  ASSERT_TRUE(cameras.ok()) << cameras.error().message();
  EXPECT_EQ(cameras.value().size(), 2U);
  EXPECT_EQ(cameras.value()[0]->statistics().opened, 0U);
}

TEST(CameraConfig, RefusesWhatCannotBe) {
  if (missing_driver("aravis")) GTEST_SKIP() << missing_driver("aravis")->what;
  CameraConfig config;
  EXPECT_NE(problem_of("aravis", config).find("camera.left"), std::string::npos);
  config.left = "192.0.2.1";
  EXPECT_NE(problem_of("aravis", config).find("camera.right"), std::string::npos);
  config.right = config.left;
  EXPECT_NE(problem_of("aravis", config).find("left camera again"), std::string::npos);
  config.right = "192.0.2.2";
  EXPECT_NE(problem_of("telepathy", config).find("telepathy"), std::string::npos);
  EXPECT_EQ(problem_of("aravis", config), "none");
}

TEST(CameraConfig, OneV4l2DeviceIsSideBySideTwoAreNot) {
  if (missing_driver("v4l2")) GTEST_SKIP() << missing_driver("v4l2")->what;
  CameraConfig config;
  config.left = "/dev/video0";
  const CaptureClock clock;
  EXPECT_EQ(make_cameras("v4l2", config, clock).value().size(), 1U);
  config.right = "/dev/video1";
  EXPECT_EQ(make_cameras("v4l2", config, clock).value().size(), 2U);
  config.trigger = "Line1";
  EXPECT_NE(problem_of("v4l2", config).find("camera.trigger"), std::string::npos);
}

TEST(CameraConfig, PairsAsConfigured) {
  CameraConfig config;
  EXPECT_EQ(sync_config(config).pair_by, PairBy::time);
  config.pair_by = "sequence";
  config.tolerance_ms = 7;
  EXPECT_EQ(sync_config(config).pair_by, PairBy::sequence);
  EXPECT_EQ(sync_config(config).tolerance_ms, 7);
}

}  // namespace
}  // namespace pelorus
