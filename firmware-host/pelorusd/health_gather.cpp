#include "firmware-host/pelorusd/health_gather.h"

#include <cstdlib>

namespace pelorus {

void gather_capture(const std::vector<CaptureStatus>& cameras, const SyncStatistics& sync, HealthReport& report) {
  CounterReport& c = report.counters;
  if (!cameras.empty()) c.pairs_captured = cameras.front().camera.frames;
  for (const CaptureStatus& status : cameras) {
    c.dropped_in_source += status.camera.skipped + status.camera.incomplete + status.camera.underruns;
    c.dropped_ring_full += status.ring.no_free_slot;
    c.dropped_superseded += status.ring.superseded;
    c.time_jumps += status.camera.time_corrections;
  }
  c.dropped_superseded += sync.superseded;
  c.dropped_unpaired = sync.unpaired_left + sync.unpaired_right + sync.out_of_tolerance + sync.time_reversed;
  if (cameras.size() > 1) report.picture.sync_error_ms = 1e-6 * static_cast<double>(sync.worst_error_ns);
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

}  // namespace pelorus
