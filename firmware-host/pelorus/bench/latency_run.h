#pragma once
// run_latency: the service's own threads (capture, vision with its helpers, publishing) on pairs from memory at a given
// rate, everything but cameras and buses, and what each result cost. Thread-bound; starts threads and ends them.

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/model/frame_report.h"
#include "firmware-host/pelorus/bench/preloaded_source.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

struct LatencyOptions {
  ServiceConfig config;
  double rate_hz = 20;
  double seconds = 30;
  double warm_up_s = 2;                       // not counted
  std::function<bool()> stop;                 // asked ten times a second; may be empty
  std::function<void(double done)> progress;  // share of the time; may be empty
};

// One released result.
struct ReleasedStep {
  FrameReport report;
  VisionState state = VisionState::init;
  bool pose_valid = false;
  bool deadline_missed = false;
  int objects = 0;
  double ready_ms = 0;     // mid-exposure to the end of the step
  double released_ms = 0;  // mid-exposure to release
  double late_us = 0;      // release against the declared moment
};

struct ThreadCost {
  std::string name;
  double cpu_ms = 0;  // over the time counted
  std::uint64_t page_faults = 0;
};

struct LatencyRun {
  std::vector<ReleasedStep> steps;  // after the warm-up
  std::vector<ThreadCost> threads;
  std::vector<std::string> refused;  // what the system did not grant
  double seconds = 0;
  bool interrupted = false;
  std::uint64_t pairs_superseded = 0;
  std::uint64_t pairs_late = 0;  // the feed itself was late
  std::uint64_t results_dropped = 0;
  std::uint64_t allocations = 0;  // of the per-frame threads
  std::uint64_t minor_faults = 0;
  std::uint64_t major_faults = 0;
  double rss_start_mb = 0;  // pictures held for the feed not counted
  double rss_end_mb = 0;
  double rss_peak_mb = 0;
};

// Errors: a calibration that cannot be rectified.
[[nodiscard]] Result<LatencyRun> run_latency(std::shared_ptr<const PreloadedPairs> pairs,
                                             const LatencyOptions& options);

}  // namespace pelorus
