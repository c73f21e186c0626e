// Keys of the service's settings.

#include "firmware-host/runtime/config_fields.h"
#include "firmware-host/runtime/field_list.h"
#include "firmware-host/runtime/lcm_url.h"

namespace pelorus {
namespace {

void list(FieldList& f, SourceConfig& c) {
  f.section("source");
  f.add("kind", c.kind, {"replay", "synthetic", "aravis", "v4l2"});
  f.add("path", c.path);
  f.add("calibration", c.calibration);
  f.add("rate_hz", c.rate_hz, 0, 1000);
  f.add("repeat", c.repeat);
}

void list(FieldList& f, CameraConfig& c) {
  f.section("camera");
  f.add("left", c.left);
  f.add("right", c.right);
  f.add("pixel_format", c.pixel_format);
  f.add("width_px", c.width_px, 0, 20000);
  f.add("height_px", c.height_px, 0, 20000);
  f.add("rate_hz", c.rate_hz, 0, 1000);
  f.add("exposure_ms", c.exposure_ms, 0, 1000);
  f.add("gain_db", c.gain_db, -1, 100);
  f.add("trigger", c.trigger);
  f.add("pair_by", c.pair_by, {"time", "sequence"});
  f.add("tolerance_ms", c.tolerance_ms, 0.001, 500);
  f.add("clock", c.clock, {"free_running", "ptp"});
  f.add("stamp_at", c.stamp_at, {"exposure_start", "mid_exposure", "exposure_end"});
  f.add("readout_ms", c.readout_ms, 0, 1000);
  f.add("packet_bytes", c.packet_bytes, 576, 16000);
  f.add("packet_socket", c.packet_socket);
  f.add("socket_buffer_mb", c.socket_buffer_mb, 0.1, 256);
  f.add("resend", c.resend);
  f.add("frame_retention_ms", c.frame_retention_ms, 1, 10000);
  f.add("buffers", c.buffers, 2, 64);
  f.add("ring_slots", c.ring_slots, 8, 64);
  f.add("reopen_after_s", c.reopen_after_s, 0.2, 60);
}

void list(FieldList& f, TimingConfig& c) {
  f.section("timing");
  f.add("latency_ms", c.latency_ms, 1, 2000);
  f.add("deadline_tolerance_ms", c.deadline_tolerance_ms, 0.1, 1000);
}

void list(FieldList& f, CaptureWatchConfig& c) {
  f.section("capture");
  f.add("frame_timeout_ms", c.frame_timeout_ms, 0, 10000);
  f.add("frozen_pairs", c.frozen_pairs, 0, 1000);
  f.add("time_jump_ms", c.time_jump_ms, 1, 10000);
}

void list(FieldList& f, MountingConfig& c) {
  f.section("mounting");
  f.add("given", c.given);
  f.add("x_m", c.x_m, -100, 100);
  f.add("y_m", c.y_m, -100, 100);
  f.add("z_m", c.z_m, -100, 100);
  f.add("roll_deg", c.roll_deg, -180, 180);
  f.add("pitch_deg", c.pitch_deg, -180, 180);
  f.add("yaw_deg", c.yaw_deg, -180, 180);
}

void list(FieldList& f, ProcessConfig& c) {
  f.section("process");
  f.add("realtime", c.realtime);
  f.add("pin", c.pin);
  f.add("lock_memory", c.lock_memory);
}

void list(FieldList& f, CanConfig& c) {
  f.section("can");
  f.add("enabled", c.enabled);
  f.add("interface", c.interface);
  f.add("fd", c.fd);
  f.add("bit_rate_switch", c.bit_rate_switch);
  f.add("base_id", c.base_id, 0, 0x7FF - 11);
  f.add("slow_every", c.slow_every, 1, 1000);
  f.add("retry_ms", c.retry_ms, 10, 60000);
}

void list(FieldList& f, LcmConfig& c) {
  f.section("lcm");
  f.add("enabled", c.enabled);
  f.add("url", c.url);
  f.add("vehicle", c.vehicle);
  f.add("commands", c.commands);
  f.add("preview_rate_hz", c.preview_rate_hz, 0, 10);
  f.add("preview_max_bytes", c.preview_max_bytes, 10000, 60000);
}

void list(FieldList& f, RecorderConfig& c) {
  f.section("recorder");
  f.add("folder", c.folder);
  f.add("at_start", c.at_start);
  f.add("format", c.format, {"png", "pgm"});
  f.add("min_free_gb", c.min_free_gb, 0, 100000);
  f.add("every", c.every, 1, 1000);
  f.add("queue_pairs", c.queue_pairs, 1, 1000);
}

}  // namespace

std::vector<ConfigField> service_fields(ServiceConfig& config) {
  FieldList fields;
  list(fields, config.source);
  list(fields, config.camera);
  list(fields, config.timing);
  list(fields, config.mounting);
  list(fields, config.capture);
  list(fields, config.lcm);
  list(fields, config.can);
  list(fields, config.recorder);
  list(fields, config.process);
  return fields.take();
}

std::vector<ConfigConflict> service_conflicts(const ServiceConfig& config) {
  std::vector<ConfigConflict> conflicts;
  const auto require = [&](bool holds, std::vector<std::string> keys, const char* rule, const char* cure) {
    if (!holds) conflicts.push_back({std::move(keys), rule, cure});
  };
  const char* const see = "see config/pelorus.yaml";
  // LCM takes 63 characters; the longest of our channels adds ".VIS_COMMAND_ACK" to the vehicle.
  require(!config.lcm.vehicle.empty() && config.lcm.vehicle.size() <= 40, {"lcm.vehicle"},
          "lcm.vehicle must have 1 to 40 characters", see);
  require(!config.lcm.enabled || config.lcm.url.empty() || is_lcm_url(config.lcm.url), {"lcm.url", "lcm.enabled"},
          "lcm.url is no address of LCM", kLcmUrlCure);
  require(config.camera.rate_hz <= 0 || config.camera.tolerance_ms < 500 / config.camera.rate_hz,
          {"camera.tolerance_ms", "camera.rate_hz"},
          "camera.tolerance_ms must be below half the period of camera.rate_hz", see);
  const MountingConfig& m = config.mounting;
  const bool mounted = m.x_m != 0 || m.y_m != 0 || m.z_m != 0 || m.roll_deg != 0 || m.pitch_deg != 0 || m.yaw_deg != 0;
  require(m.given || !mounted, {"mounting.given", "mounting.pitch_deg", "mounting.x_m"},
          "mounting has values that would not be used", "set mounting.given to true, or leave the values out");
  if (config.source.kind != "aravis" && config.source.kind != "v4l2") return conflicts;
  require(!config.source.calibration.empty(), {"source.calibration", "source.kind"},
          "source.calibration must name a file for live cameras", see);
  for (const CameraProblem& problem : camera_problems(config.source.kind, config.camera)) {
    const std::string key = "camera." + problem.key;
    conflicts.push_back({{key, "source.kind"}, key + " " + problem.what, problem.cure});
  }
  return conflicts;
}

}  // namespace pelorus
