#pragma once
// What VIS_HEALTH says, once a second and at changes; also the source of log lines. Units in the names; NaN = unknown.
// Pure data.

#include <cstdint>
#include <limits>
#include <string>

#include "core/base/time.h"
#include "core/model/stage_data.h"
#include "services/publisher.h"

namespace pelorus {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Of the last full period of reports.
struct TimingReport {
  double pairs_rate_hz = 0;
  double results_rate_hz = 0;
  double interval_max_ms = kUnknown;     // between captured pairs
  double interval_jitter_ms = kUnknown;  // longest less shortest
  double latency_p50_ms = kUnknown;      // mid-exposure to release
  double latency_p99_ms = kUnknown;
  double latency_max_ms = kUnknown;
  double release_jitter_ms = kUnknown;  // latest less earliest against the declared moment
  double step_p50_ms = kUnknown;
  double step_max_ms = kUnknown;
};

// Since the service started.
struct CounterReport {
  std::uint64_t pairs_captured = 0;
  std::uint64_t results_published = 0;
  std::uint64_t deadline_misses = 0;
  std::uint64_t dropped_in_source = 0;
  std::uint64_t dropped_ring_full = 0;
  std::uint64_t dropped_superseded = 0;
  std::uint64_t dropped_unpaired = 0;
  std::uint64_t results_dropped = 0;
  std::uint64_t camera_timeouts = 0;
  std::uint64_t frozen_spells = 0;
  std::uint64_t steps_shed = 0;
  std::uint64_t time_jumps = 0;
  std::uint64_t losses_of_track = 0;
  std::uint64_t lcm_errors = 0;
  std::uint64_t lcm_reconnects = 0;
  std::uint64_t previews_skipped = 0;
  std::uint64_t pictures_incomplete = 0;
  std::uint64_t packets_missing = 0;
  std::uint64_t packets_resent = 0;
  std::uint64_t camera_reopens = 0;
  std::uint64_t can_sets_sent = 0;
  std::uint64_t can_sets_dropped = 0;
  std::uint64_t can_sets_unheard = 0;
  std::uint64_t can_error_frames = 0;
  std::uint64_t can_bus_offs = 0;
  std::uint64_t recorder_pairs_written = 0;
  std::uint64_t recorder_pairs_dropped = 0;
  std::uint64_t recorder_pairs_failed = 0;
};

struct PictureReport {
  double sync_error_ms = kUnknown;
  double exposure_ms = kUnknown;
  double mean_grey = kUnknown;
  double contrast_grey = kUnknown;
  double sigma_px = kUnknown;
};

struct HostReport {
  double cpu_percent = kUnknown;  // of one processor
  double memory_mb = kUnknown;
  double temperature_degc = kUnknown;
  double disk_free_gb = kUnknown;
};

struct HealthReport {
  Timestamp time;
  std::uint64_t seq = 0;
  double uptime_s = 0;
  VisionState state = VisionState::init;
  StateReason reason = StateReason::starting;
  TimingReport timing;
  CounterReport counters;
  PictureReport picture;
  HostReport host;
  double wall_step_s = kUnknown;  // of the wall clock against the clock of all times since the start
  std::string version;
  std::string recorder_text;
  std::string can_text;
  std::string privileges_text;
  std::string config_hash;
  std::string calibration_hash;
};

}  // namespace pelorus
