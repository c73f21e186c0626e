// The page of `pelorus top`, from made-up messages.
#include "firmware-host/pelorus/top/status_page.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <numbers>

#include "services/lcm_messages.h"
#include "tests/services/lcm_loopback.h"

namespace pelorus {
namespace {

const ArrivalTime kNow = ArrivalTime() + std::chrono::hours(1);

ArrivalTime ago(double seconds) {
  return kNow - std::chrono::duration_cast<ArrivalTime::duration>(std::chrono::duration<double>(seconds));
}

// Looking ahead from the origin at 0.5 m/s; one body 4 m ahead that goes away at 0.2 m/s, one without velocity.
BusView small_view() {
  BusView view;
  view.vehicle = "AUV";
  view.url = "udpm://239.255.76.67:7667?ttl=0";
  view.odom_rate_hz = 20;
  vis_odom_t odom{};
  odom.utime = 1000;
  odom.state = vis_odom_t::STATE_TRACKING;
  odom.state_text = "TRACKING";
  odom.pose_valid = odom.velocity_valid = true;
  odom.quality_percent = 87;
  odom.quat_wxyz[0] = 1;
  odom.vel_body_mps[0] = 0.5;
  view.odom = {odom, ago(0.05)};
  vis_tracks_t tracks{};
  tracks.utime = 1000;
  vis_track_t body{};
  body.id = 3;
  body.phase = vis_track_t::PHASE_CONFIRMED;
  body.phase_text = "CONFIRMED";
  body.velocity_valid = true;
  body.vel_world_mps[0] = 0.2;
  body.centroid_body_m[0] = body.range_m = 4;
  body.points = 41;
  vis_track_t second = body;
  second.id = 7;
  second.range_m = 9;
  second.velocity_valid = false;
  tracks.tracks = {second, body};
  tracks.n_tracks = tracks.n_confirmed = 2;
  view.tracks = {tracks, ago(0.05)};
  vis_health_t health{};
  health.state = odom.state;
  health.pairs_rate_hz = 20;
  health.latency_p50_ms = 100.06;
  health.temperature_degc = std::nan("");
  health.dropped_superseded = 12;
  health.disk_free_gb = 78.5;
  health.wall_step_s = 0.25;
  health.can_text = "can0 active, 12 sets, 0 dropped, 0 error frames, 0 bus-offs";
  health.recorder_text = "off";
  health.privileges_text = "real time, memory not locked: the limit is 64 kB, 2 threads pinned";
  health.can_sets_dropped = 17;
  health.camera_reopens = 18;
  health.steps_shed = 19;
  health.version = "0.1.0";
  view.health = {health, ago(0.5)};
  view.health_before = view.health;
  view.health_before->message.dropped_superseded = 9;
  return view;
}

std::string page_text(const BusView& view, PageSize size = {}) {
  std::string all;
  for (const PageLine& line : status_page(view, kNow, size)) all += plain_text(line) + "\n";
  return all;
}

// The line that begins with a label.
std::string line_of(const BusView& view, const std::string& label, PageSize size = {}) {
  for (const PageLine& line : status_page(view, kNow, size)) {
    if (plain_text(line).starts_with(label)) return plain_text(line);
  }
  return "no line " + label;
}

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

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

TEST(StatusPage, AWallClockThatWasSetIsInTheJson) {
  EXPECT_EQ(YAML::Load(status_json(small_view(), kNow))["health"]["wall_step_s"].as<double>(), 0.25);
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

TEST(StatusPage, NoSizeMakesALineTooManyOrTooLong) {
  BusView view = small_view();
  view.health->message.can_text = std::string(300, 'x');
  for (int k = 0; k < 30; ++k) view.tracks->message.tracks.push_back(view.tracks->message.tracks[0]);
  for (int rows = 1; rows < 60; ++rows) {
    for (const int columns : {1, 20, 80, 200}) {
      const auto page = status_page(view, kNow, {columns, rows});
      EXPECT_EQ(page.size(), static_cast<std::size_t>(rows));
      for (const PageLine& line : page) EXPECT_LE(plain_text(line).size(), static_cast<std::size_t>(columns));
    }
  }
  // 24 rows have room for five bodies and the count of the others; 60 for all.
  EXPECT_TRUE(says(page_text(view), "... and 27 farther away")) << page_text(view);
  EXPECT_FALSE(says(page_text(view, {80, 60}), "farther"));
}

TEST(StatusPage, EverythingFitsIntoEightyColumnsWithLargeNumbers) {
  BusView view = small_view();
  vis_odom_t& odom = view.odom->message;
  odom.pos_m[0] = odom.pos_m[1] = -1234.567;
  odom.pos_m[2] = 234.567;
  const double angle_rad = 179.9 / 180 * std::numbers::pi;
  odom.quat_wxyz[0] = std::cos(angle_rad / 2);
  odom.quat_wxyz[3] = -std::sin(angle_rad / 2);
  for (double& v : odom.vel_body_mps) v = -1.25;
  for (double& w : odom.rate_body_radps) w = -0.5;
  odom.points_static = 512;
  odom.reset_counter = 12;
  vis_health_t& health = view.health->message;
  health.pairs_rate_hz = health.results_rate_hz = 100.1;
  health.interval_max_ms = 1234;
  health.interval_jitter_ms = 1234.5;
  health.release_jitter_ms = 12.34;
  health.latency_p50_ms = health.latency_p99_ms = health.latency_max_ms = 123.4;
  health.step_p50_ms = health.step_max_ms = 56.7;
  const auto page = status_page(view, kNow, {300, 24});
  for (std::size_t i = 0; i < page.size(); ++i) EXPECT_LE(plain_text(page[i]).size(), 80U) << plain_text(page[i]);
}

TEST(StatusPage, WhatDoesNotFitIntoALineGoesOnBelow) {
  BusView view = small_view();
  vis_health_t& m = view.health->message;
  m.losses_of_track = m.camera_timeouts = m.frozen_spells = m.time_jumps = 1234;
  m.lcm_errors = m.deadline_misses = m.steps_shed = 1234;
  m.privileges_text =
      "no real-time scheduling: the limit is 0, memory not locked: the limit is 64 kB, 2 threads pinned";
  view.odom->message.state_text = "DEGRADED";
  view.odom->message.reason_text = "which group is the world is unclear";
  const std::string all = page_text(view, {80, 24});
  EXPECT_TRUE(says(all, "late 1234 (+1234)\n         shed 1234 (+1215)\n")) << all;
  EXPECT_TRUE(says(all, "\n         is 64 kB, 2 threads pinned\n")) << all;
  EXPECT_TRUE(says(all, "unclear\n         quality 87 %   resets 0   points 0 static, 0 moving\n")) << all;
  EXPECT_TRUE(says(all, "   3  CONFIRMED")) << "there is room for bodies still\n" << all;
  view.health->at = ago(60);
  EXPECT_TRUE(says(page_text(view, {80, 24}), " shed 1234 (+1215)\n")) << "old, too";
}

TEST(StatusPage, ColorsAreAddedToTheWordsAndTakenBack) {
  const PageLine line{{PageStyle::plain, "a "}, {PageStyle::bad, "b"}, {PageStyle::good, ""}};
  EXPECT_EQ(plain_text(line), "a b");
  EXPECT_EQ(colored_text(line), "a \033[1;31mb\033[0m");
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

TEST(StatusPage, JsonHoldsTheFactsOfRealMessages) {
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
