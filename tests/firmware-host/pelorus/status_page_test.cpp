// The page of `pelorus top`, from made-up messages.
#include "firmware-host/pelorus/top/status_page.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <numbers>

#include "tests/firmware-host/pelorus/made_up_bus.h"

namespace pelorus {
namespace {

using test::ago;
using test::kNow;
using test::line_of;
using test::page_text;
using test::says;
using test::small_view;

TEST(StatusPage, TellsStateRatesDropsBusAndDisk) {
  const BusView view = small_view();
  EXPECT_EQ(line_of(view, "STATE"), "STATE    TRACKING   quality 87 %   resets 0   points 0 static, 0 moving");
  EXPECT_TRUE(says(line_of(view, "MOTION"), "ahead 0.50")) << line_of(view, "MOTION");
  EXPECT_TRUE(says(line_of(view, "LATENCY"), "p50 100.1")) << line_of(view, "LATENCY");
  EXPECT_TRUE(says(line_of(view, "RATES"), "pairs 20.0 results 0.0 heard 20.0 Hz")) << line_of(view, "RATES");
  EXPECT_TRUE(says(line_of(view, "DROPS"), "overtaken 12 (+3)  unpaired 0")) << line_of(view, "DROPS");
  EXPECT_TRUE(says(line_of(view, "HOST"), "  - C")) << line_of(view, "HOST");
  EXPECT_TRUE(says(line_of(view, "CAN"), "can0 active, 12 sets")) << line_of(view, "CAN");
  EXPECT_TRUE(says(line_of(view, "DISK"), "78.5 GB free")) << line_of(view, "DISK");
  EXPECT_TRUE(says(line_of(view, "GRANTED"), "memory not locked: the limit is 64 kB")) << line_of(view, "GRANTED");
}

TEST(StatusPage, EachFaultIsToldWithItsOwnCountAndWhatIsNew) {
  BusView view = small_view();
  vis_health_t& m = view.health->message;
  m.losses_of_track = 1;
  m.camera_timeouts = 2;
  m.frozen_spells = 3;
  m.time_jumps = 4;
  m.lcm_errors = 5;
  m.deadline_misses = 6;
  m.steps_shed = 7;
  view.health_before->message = m;
  view.health_before->message.steps_shed = 5;
  EXPECT_EQ(line_of(view, "FAULTS"), "FAULTS   losses 1  silent 2  frozen 3  jumps 4  LCM 5  late 6  shed 7 (+2)");
}

TEST(StatusPage, BodiesAreListedByRangeWithClosingSpeed) {
  const std::string all = page_text(small_view());
  // Closing: 0.5 of the vehicle less 0.2 of the body.
  EXPECT_TRUE(says(all, "   3  CONFIRMED     4.00        0.30       0.20         0        0      41\n")) << all;
  EXPECT_TRUE(says(all, "   7  CONFIRMED     9.00           -          -")) << all;
  EXPECT_LT(all.find("   3  CONFIRMED"), all.find("   7  CONFIRMED"));
}

TEST(StatusPage, ClosingSpeedIsWhatTheRangesOfTwoPairsSay) {
  vis_odom_t odom = small_view().odom->message;
  vis_tracks_t tracks = small_view().tracks->message;
  vis_track_t body = tracks.tracks[1];
  // Turned by 90 degrees to starboard: body x is world y. The vehicle moves along it, the body along world x.
  odom.quat_wxyz[0] = odom.quat_wxyz[3] = std::sqrt(0.5);
  body.centroid_body_m[0] = 3;
  body.centroid_body_m[1] = -4;  // port: world x
  const double step_s = 1e-4;
  // World: the vehicle at the origin goes to y = 0.5 step, the body at (4, 3) to x = 4 + 0.2 step.
  const double after_m = std::hypot(4 + 0.2 * step_s, 3 - 0.5 * step_s);
  EXPECT_NEAR(closing_speed_mps(body, tracks, odom), (5 - after_m) / step_s, 1e-4);
  EXPECT_NEAR(attitude_of(odom).yaw_rad, std::numbers::pi / 2, 1e-9);
  EXPECT_NEAR(direction_of(body).bearing_rad, std::atan2(-4, 3), 1e-9);
  odom.utime += 1;  // of another pair
  EXPECT_TRUE(std::isnan(closing_speed_mps(body, tracks, odom)));
}

TEST(StatusPage, WhatIsOldIsToldToBeOldOnEveryLine) {
  BusView view = small_view();
  view.odom->at = view.tracks->at = ago(4.2);
  EXPECT_EQ(line_of(view, "STATE").substr(0, 35), "STATE    STALE 4.2 s, last TRACKING");
  for (const char* label : {"POSE", "MOTION", "BODIES"}) {
    EXPECT_EQ(line_of(view, label).substr(9, 11), "STALE 4.2 s") << label;
  }
  EXPECT_FALSE(says(line_of(view, "RATES"), "STALE"));
  view.health->at = ago(60);
  for (const char* label : {"LATENCY", "RATES", "DROPS", "FAULTS", "PICTURE", "HOST", "GRANTED", "CAN", "DISK"}) {
    EXPECT_EQ(line_of(view, label).substr(9, 12), "STALE 60.0 s") << label;
  }
  // The good color of a state goes with its freshness.
  for (const PageLine& line : status_page(view, kNow, {})) {
    for (const PageSpan& span : line) EXPECT_NE(span.style, PageStyle::good) << span.text;
  }
}

TEST(StatusPage, WhatWasNeverHeardIsNoZero) {
  BusView view;
  view.vehicle = "AUV";
  view.trouble = "LCM cannot be opened";
  const std::string all = page_text(view);
  EXPECT_TRUE(says(all, "STATE    NOT HEARD YET")) << all;
  EXPECT_TRUE(says(all, "HEALTH   NOT HEARD YET")) << all;
  EXPECT_TRUE(says(all, "BODIES   NOT HEARD YET")) << all;
  EXPECT_TRUE(says(all, "LCM cannot be opened")) << all;
  EXPECT_FALSE(says(all, "0.0")) << all;
}

TEST(StatusPage, ARateNeedsTwoMessagesAndSilenceIsOne) {
  BusView view = small_view();
  view.odom_rate_hz = heard_rate_hz({ago(0.1)}, true);  // what `--once` has mostly heard
  EXPECT_TRUE(says(line_of(view, "RATES"), "heard - Hz")) << line_of(view, "RATES");
  EXPECT_TRUE(YAML::Load(status_json(view, kNow))["odom"]["heard_rate_hz"].IsNull());
  EXPECT_TRUE(std::isnan(heard_rate_hz({ago(0.1), ago(0.1)}, true))) << "together out of a queue";
  EXPECT_TRUE(std::isnan(BusView().odom_rate_hz));
  EXPECT_TRUE(std::isnan(heard_rate_hz({}, false)));
  EXPECT_NEAR(heard_rate_hz({ago(0.5), ago(0.3), ago(0.1)}, true), 5, 1e-6);
  EXPECT_EQ(heard_rate_hz({}, true), 0) << "fell silent";
}

TEST(StatusPage, AnInvalidPoseIsNotShown) {
  BusView view = small_view();
  view.odom->message.pose_valid = false;
  view.odom->message.pos_m[0] = 123.4;
  view.odom->message.state = vis_odom_t::STATE_LOST;
  view.odom->message.state_text = "LOST";
  view.odom->message.reason_text = "few points";
  view.odom->message.quality_percent = -1;
  const std::string all = page_text(view);
  EXPECT_FALSE(says(all, "123.4")) << all;
  EXPECT_TRUE(says(all, "STATE    LOST: few points   quality - %")) << all;
  EXPECT_TRUE(says(all, "POSE     invalid")) << all;
}

TEST(StatusPage, ColorFollowsTheState) {
  const auto style = [](std::int8_t state) {
    BusView view = small_view();
    view.odom->message.state = state;
    for (const PageLine& line : status_page(view, kNow, {})) {
      for (const PageSpan& span : line)
        if (span.text == "TRACKING") return span.style;
    }
    return PageStyle::plain;
  };
  EXPECT_EQ(style(vis_odom_t::STATE_TRACKING), PageStyle::good);
  EXPECT_EQ(style(vis_odom_t::STATE_DEGRADED), PageStyle::warning);
  EXPECT_EQ(style(vis_odom_t::STATE_LOST), PageStyle::bad);
  EXPECT_EQ(style(vis_odom_t::STATE_CAMERA_FAULT), PageStyle::bad);
}

}  // namespace
}  // namespace pelorus
