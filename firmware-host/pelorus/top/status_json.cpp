#include <limits>

#include "firmware-host/pelorus/json_object.h"
#include "firmware-host/pelorus/top/status_page.h"

namespace pelorus {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::string numbers(const double* values, std::size_t count) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) texts.push_back(json_number(values[i]));
  return json_array(texts);
}

std::string odom_json(const BusView& view, ArrivalTime now) {
  if (!view.odom) return "null";
  const vis_odom_t& m = view.odom->message;
  return JsonObject()
      .number("age_s", view.odom->age_s(now))
      .flag("stale", is_stale(view.odom, now, kStalePairs_s))
      .integer("utime", m.utime)
      .integer("seq", m.seq)
      .text("state", m.state_text)
      .text("reason", m.reason_text)
      .flag("pose_valid", m.pose_valid)
      .integer("quality_percent", m.quality_percent)
      .integer("reset_counter", m.reset_counter)
      .number("latency_ms", m.latency_ms)
      .flag("deadline_missed", m.deadline_missed)
      .number("heard_rate_hz", view.odom_rate_hz)
      .integer("points_static", m.points_static)
      .integer("points_moving", m.points_moving)
      .number("world_confidence", m.world_confidence)
      .raw("pos_m", numbers(m.pos_m, 3))
      .raw("quat_wxyz", numbers(m.quat_wxyz, 4))
      .raw("vel_body_mps", numbers(m.vel_body_mps, 3))
      .raw("rate_body_radps", numbers(m.rate_body_radps, 3))
      .str();
}

std::string bodies_json(const BusView& view, ArrivalTime now) {
  if (!view.tracks) return "null";
  const vis_tracks_t& m = view.tracks->message;
  std::vector<std::string> bodies;
  for (const vis_track_t& track : m.tracks) {
    const Direction to = direction_of(track);
    bodies.push_back(JsonObject()
                         .integer("id", track.id)
                         .text("phase", track.phase_text)
                         .integer("points", track.points)
                         .number("range_m", track.range_m)
                         .number("closing_mps", view.odom ? closing_speed_mps(track, m, view.odom->message) : kUnknown)
                         .number("bearing_rad", to.bearing_rad)
                         .number("elevation_rad", to.elevation_rad)
                         .flag("velocity_valid", track.velocity_valid)
                         .raw("vel_world_mps", numbers(track.vel_world_mps, 3))
                         .raw("centroid_world_m", numbers(track.centroid_world_m, 3))
                         .raw("extent_m", numbers(track.extent_m, 3))
                         .str());
  }
  return JsonObject()
      .number("age_s", view.tracks->age_s(now))
      .flag("stale", is_stale(view.tracks, now, kStalePairs_s))
      .integer("utime", m.utime)
      .integer("confirmed", m.n_confirmed)
      .raw("bodies", json_array(bodies))
      .str();
}

void put_counters(const vis_health_t& m, JsonObject& json) {
  json.integer("pairs_captured", m.pairs_captured)
      .integer("results_published", m.results_published)
      .integer("deadline_misses", m.deadline_misses)
      .integer("steps_shed", m.steps_shed)
      .integer("dropped_in_source", m.dropped_in_source)
      .integer("dropped_ring_full", m.dropped_ring_full)
      .integer("dropped_superseded", m.dropped_superseded)
      .integer("dropped_unpaired", m.dropped_unpaired)
      .integer("results_dropped", m.results_dropped)
      .integer("camera_timeouts", m.camera_timeouts)
      .integer("frozen_spells", m.frozen_spells)
      .integer("time_jumps", m.time_jumps)
      .integer("losses_of_track", m.losses_of_track)
      .integer("lcm_errors", m.lcm_errors)
      .integer("pictures_incomplete", m.pictures_incomplete)
      .integer("packets_missing", m.packets_missing)
      .integer("packets_resent", m.packets_resent)
      .integer("camera_reopens", m.camera_reopens)
      .integer("can_sets_sent", m.can_sets_sent)
      .integer("can_sets_dropped", m.can_sets_dropped)
      .integer("can_sets_unheard", m.can_sets_unheard)
      .integer("can_error_frames", m.can_error_frames)
      .integer("can_bus_offs", m.can_bus_offs)
      .integer("recorder_pairs_written", m.recorder_pairs_written)
      .integer("recorder_pairs_dropped", m.recorder_pairs_dropped)
      .integer("recorder_pairs_failed", m.recorder_pairs_failed);
}

std::string health_json(const BusView& view, ArrivalTime now) {
  if (!view.health) return "null";
  const vis_health_t& m = view.health->message;
  JsonObject json;
  json.number("age_s", view.health->age_s(now))
      .flag("stale", is_stale(view.health, now, kStaleHealth_s))
      .integer("utime", m.utime)
      .text("version", m.version)
      .number("uptime_s", m.uptime_s)
      .number("pairs_rate_hz", m.pairs_rate_hz)
      .number("results_rate_hz", m.results_rate_hz)
      .number("interval_max_ms", m.interval_max_ms)
      .number("latency_p50_ms", m.latency_p50_ms)
      .number("latency_p99_ms", m.latency_p99_ms)
      .number("latency_max_ms", m.latency_max_ms)
      .number("release_jitter_ms", m.release_jitter_ms)
      .number("step_p50_ms", m.step_p50_ms)
      .number("step_max_ms", m.step_max_ms);
  put_counters(m, json);
  return json.number("sync_error_ms", m.sync_error_ms)
      .number("exposure_ms", m.exposure_ms)
      .number("cpu_percent", m.cpu_percent)
      .number("memory_mb", m.memory_mb)
      .number("temperature_degc", m.temperature_degc)
      .number("disk_free_gb", m.disk_free_gb)
      .number("wall_step_s", m.wall_step_s)
      .text("recorder", m.recorder_text)
      .text("can", m.can_text)
      .text("privileges", m.privileges_text)
      .text("config_hash", m.config_hash)
      .text("calibration_hash", m.calibration_hash)
      .str();
}

}  // namespace

std::string status_json(const BusView& view, ArrivalTime now) {
  return JsonObject()
      .text("vehicle", view.vehicle)
      .text("url", view.url)
      .text("trouble", view.trouble)
      .raw("odom", odom_json(view, now))
      .raw("tracks", bodies_json(view, now))
      .raw("health", health_json(view, now))
      .str();
}

}  // namespace pelorus
