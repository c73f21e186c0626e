#include "firmware-host/runtime/settings_hash.h"

#include <gtest/gtest.h>

#include <set>

namespace pelorus {
namespace {

TEST(SettingsHash, EqualSettingsAgreeAndEachChangeShows) {
  const ServiceConfig defaults;
  EXPECT_EQ(config_hash(defaults), config_hash(ServiceConfig{}));
  EXPECT_EQ(config_hash(defaults).size(), 16U);
  std::set<std::string> hashes{config_hash(defaults)};
  ServiceConfig changed = defaults;
  changed.lcm.vehicle = "OTHER";
  hashes.insert(config_hash(changed));
  changed.pipeline.steps.net_filter = false;
  hashes.insert(config_hash(changed));
  changed.pipeline.front_end.max_points += 1;
  hashes.insert(config_hash(changed));
  changed.timing.latency_ms += 1e-9;
  hashes.insert(config_hash(changed));
  EXPECT_EQ(hashes.size(), 5U);
}

TEST(SettingsHash, OnlyWhatDiffersFromTheDefaultsIsListed) {
  ServiceConfig config;
  EXPECT_EQ(changed_settings(config), "");
  config.source.path = "/dive";
  config.timing.latency_ms = 80;
  EXPECT_EQ(changed_settings(config), "source.path='/dive', timing.latency_ms=80");
}

TEST(SettingsHash, AnyNumberOfTheCalibrationCounts) {
  StereoCalibration calibration;
  calibration.left.fx_px = 500;
  std::set<std::string> hashes{calibration_hash(calibration)};
  calibration.right.distortion[7] = 1e-12;
  hashes.insert(calibration_hash(calibration));
  calibration.T_right_left.translation().x() = -0.12;
  hashes.insert(calibration_hash(calibration));
  calibration.rectified = true;
  hashes.insert(calibration_hash(calibration));
  EXPECT_EQ(hashes.size(), 4U);
}

}  // namespace
}  // namespace pelorus
