// How the page of `pelorus top` fits into a terminal.
#include "firmware-host/pelorus/top/page_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/firmware-host/pelorus/made_up_bus.h"

namespace pelorus {
namespace {

using test::ago;
using test::kNow;
using test::page_text;
using test::says;
using test::small_view;

TEST(PageWriter, NoSizeMakesALineTooManyOrTooLong) {
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

TEST(PageWriter, EverythingFitsIntoEightyColumnsWithLargeNumbers) {
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

TEST(PageWriter, WhatDoesNotFitIntoALineGoesOnBelow) {
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

TEST(PageWriter, ColorsAreAddedToTheWordsAndTakenBack) {
  const PageLine line{{PageStyle::plain, "a "}, {PageStyle::bad, "b"}, {PageStyle::good, ""}};
  EXPECT_EQ(plain_text(line), "a b");
  EXPECT_EQ(colored_text(line), "a \033[1;31mb\033[0m");
}

}  // namespace
}  // namespace pelorus
