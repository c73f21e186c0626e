// Keys of the service's settings.

#include "firmware-host/runtime/config_fields.h"
#include "firmware-host/runtime/field_list.h"

namespace pelorus {
namespace {

void list(FieldList& f, SourceConfig& c) {
  f.section("source");
  f.add("kind", c.kind, {"replay", "synthetic"});
  f.add("path", c.path);
  f.add("calibration", c.calibration);
  f.add("rate_hz", c.rate_hz, 0, 1000);
  f.add("repeat", c.repeat);
}

void list(FieldList& f, TimingConfig& c) {
  f.section("timing");
  f.add("latency_ms", c.latency_ms, 1, 2000);
  f.add("deadline_tolerance_ms", c.deadline_tolerance_ms, 0.1, 1000);
}

void list(FieldList& f, CaptureWatchConfig& c) {
  f.section("capture");
  f.add("frame_timeout_ms", c.frame_timeout_ms, 10, 10000);
  f.add("frozen_pairs", c.frozen_pairs, 0, 1000);
  f.add("time_jump_ms", c.time_jump_ms, 1, 10000);
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

}  // namespace

std::vector<ConfigField> service_fields(ServiceConfig& config) {
  FieldList fields;
  list(fields, config.source);
  list(fields, config.timing);
  list(fields, config.capture);
  list(fields, config.lcm);
  return fields.take();
}

std::vector<std::string> service_conflicts(const ServiceConfig& config) {
  std::vector<std::string> conflicts;
  const auto require = [&](bool holds, const char* rule) {
    if (!holds) conflicts.emplace_back(rule);
  };
  // LCM takes 63 characters; the longest of our channels adds ".VIS_COMMAND_ACK" to the vehicle.
  require(!config.lcm.vehicle.empty() && config.lcm.vehicle.size() <= 40, "lcm.vehicle must have 1 to 40 characters");
  return conflicts;
}

}  // namespace pelorus
