// The page of `pelorus top` as JSON.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "services/lcm_messages.h"
#include "tests/firmware-host/pelorus/made_up_bus.h"
#include "tests/services/lcm_loopback.h"

namespace pelorus {
namespace {

using test::ago;
using test::kNow;
using test::small_view;

TEST(StatusJson, AWallClockThatWasSetIsInTheJson) {
  EXPECT_EQ(YAML::Load(status_json(small_view(), kNow))["health"]["wall_step_s"].as<double>(), 0.25);
}

TEST(StatusJson, JsonHoldsTheFactsOfRealMessages) {
  const BodyFrames frames(Rigid3::Identity());
  const Publication publication = test::rich_publication();
  BusView view = small_view();
  view.odom = {odom_message(publication, frames), ago(0.5)};
  view.tracks = {tracks_message(publication, frames), ago(1.5)};
  const YAML::Node json = YAML::Load(status_json(view, kNow));
  EXPECT_EQ(json["odom"]["state"].as<std::string>(), "DEGRADED");
  EXPECT_NEAR(json["odom"]["age_s"].as<double>(), 0.5, 1e-6);
  EXPECT_FALSE(json["odom"]["stale"].as<bool>());
  EXPECT_TRUE(json["tracks"]["stale"].as<bool>());
  ASSERT_EQ(json["tracks"]["bodies"].size(), 2U);
  EXPECT_EQ(json["tracks"]["bodies"][0]["id"].as<int>(), 5);
  EXPECT_NEAR(json["tracks"]["bodies"][0]["range_m"].as<double>(), Eigen::Vector3d(0.3, -0.2, 4).norm(), 1e-6);
  EXPECT_TRUE(json["health"]["temperature_degc"].IsNull());
  EXPECT_EQ(json["health"]["dropped_superseded"].as<int>(), 12);
  EXPECT_EQ(json["health"]["can_sets_dropped"].as<int>(), 17);
  EXPECT_EQ(json["health"]["camera_reopens"].as<int>(), 18);
  EXPECT_EQ(json["health"]["steps_shed"].as<int>(), 19);
  EXPECT_EQ(json["health"]["privileges"].as<std::string>(), view.health->message.privileges_text);
}

}  // namespace
}  // namespace pelorus
