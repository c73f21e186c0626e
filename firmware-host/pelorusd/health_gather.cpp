#include "firmware-host/pelorusd/health_gather.h"

#include <cstdlib>

namespace pelorus {

void gather_capture(const std::vector<CaptureStatus>& cameras, const SyncStatistics& sync,
                    std::optional<std::int64_t> worst_sync_error_ns, HealthReport& report) {
  CounterReport& c = report.counters;
  if (!cameras.empty()) c.pairs_captured = cameras.front().camera.frames;
  for (const CaptureStatus& status : cameras) {
    c.dropped_in_source += status.camera.skipped + status.camera.incomplete;
    c.dropped_ring_full += status.ring.no_free_slot;
    c.dropped_superseded += status.ring.superseded;
    c.time_jumps += status.camera.time_corrections;
    c.pictures_incomplete += status.camera.incomplete;
    c.packets_missing += status.camera.missing_packets;
    c.packets_resent += status.camera.resent_packets;
    c.camera_reopens += status.camera.restarts + (status.camera.opened > 0 ? status.camera.opened - 1 : 0);
  }
  c.dropped_superseded += sync.superseded;
  c.dropped_unpaired = sync.unpaired_left + sync.unpaired_right + sync.out_of_tolerance + sync.time_reversed;
  if (cameras.size() > 1 && worst_sync_error_ns) {
    report.picture.sync_error_ms = 1e-6 * static_cast<double>(*worst_sync_error_ns);
  }
}

void gather_vision(const VisionStatus& vision, HealthReport& report) {
  report.counters.camera_timeouts = vision.missing_spells;
  report.counters.frozen_spells = vision.frozen_spells;
  report.counters.steps_shed = vision.steps_shed;
  report.counters.time_jumps += vision.time_jumps;
  report.picture.mean_grey = vision.mean_grey;
  report.picture.contrast_grey = vision.contrast_grey;
  if (vision.exposure_ms > 0) report.picture.exposure_ms = vision.exposure_ms;
}

void gather_can(const CanStatus& can, const std::string& interface, HealthReport& report) {
  CounterReport& c = report.counters;
  c.can_sets_sent = can.sets_sent;
  c.can_sets_dropped = can.sets_dropped;
  c.can_sets_unheard = can.sets_unheard;
  c.can_error_frames = can.bus.error_frames;
  c.can_bus_offs = can.bus.bus_offs;
  report.can_text = status_text(can, interface);
}

void gather_recorder(const RecorderStatus& recorder, HealthReport& report) {
  CounterReport& c = report.counters;
  c.recorder_pairs_written = recorder.written;
  c.recorder_pairs_dropped = recorder.dropped;
  c.recorder_pairs_failed = recorder.failed;
  report.recorder_text = summary(recorder);
}

void gather_service(const ServiceThreads& service, HealthReport& report) {
  StereoSync& sync = service.head->sync();
  gather_capture(service.head->status(), sync.statistics(), sync.take_worst_error_ns(), report);
  if (service.vision) gather_vision(service.vision->status(), report);
  report.counters.results_dropped = service.desk.results.dropped();
  report.counters.previews_skipped = service.preview->skipped();
  if (service.lcm) {
    report.counters.lcm_errors = service.lcm->link().errors();
    report.counters.lcm_reconnects = service.lcm->link().reconnects();
  }
  report.can_text = "off";
  if (service.can) gather_can(service.can->status(), service.config.can.interface, report);
  gather_recorder(service.recorder->status(), report);
  report.privileges_text = service.privileges.text();
  report.config_hash = service.config_fingerprint;
  report.calibration_hash = service.calibration_fingerprint;
}

std::vector<OutputTrouble> output_troubles(const ServiceThreads& service, const HealthReport& report) {
  std::vector<OutputTrouble> found;
  if (service.can && !service.can->status().trouble.empty()) found.push_back({"can", service.can->status().trouble});
  const RecorderState recorder = service.recorder->status().state;
  if (recorder == RecorderState::disk_full || recorder == RecorderState::failed) {
    found.push_back({"recorder", "recorder: " + report.recorder_text});
  }
  // Opened with the first message: before, nothing is known of it.
  if (service.lcm && !service.lcm->link().works() && report.counters.lcm_errors > 0) {
    found.push_back({"lcm", "LCM cannot be reached at " + service.config.lcm.url});
  }
  return found;
}

std::string outputs_state(const ServiceThreads& service) {
  std::string state;
  if (service.can) {
    const CanStatus can = service.can->status();
    state += std::string(to_text(can.bus.state)) + " " + can.trouble;
  }
  const RecorderStatus recorder = service.recorder->status();
  state += std::string(" | ") + text(recorder.state) + " " + recorder.folder + " | ";
  if (service.lcm) state += service.lcm->link().works() ? "open" : "closed";
  return state;
}

}  // namespace pelorus
