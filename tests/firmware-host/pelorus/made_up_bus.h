#pragma once
// Messages as `pelorus top` hears them, made up, and its page of them as text.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "firmware-host/pelorus/top/status_page.h"

namespace pelorus::test {

inline const ArrivalTime kNow = ArrivalTime() + std::chrono::hours(1);

inline ArrivalTime ago(double seconds) {
  return kNow - std::chrono::duration_cast<ArrivalTime::duration>(std::chrono::duration<double>(seconds));
}

// Looking ahead from the origin at 0.5 m/s; one body 4 m ahead that goes away at 0.2 m/s, one without velocity.
inline BusView small_view() {
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

inline std::string page_text(const BusView& view, PageSize size = {}) {
  std::string all;
  for (const PageLine& line : status_page(view, kNow, size)) all += plain_text(line) + "\n";
  return all;
}

// The line that begins with a label.
inline std::string line_of(const BusView& view, const std::string& label, PageSize size = {}) {
  for (const PageLine& line : status_page(view, kNow, size)) {
    if (plain_text(line).starts_with(label)) return plain_text(line);
  }
  return "no line " + label;
}

inline bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace pelorus::test
