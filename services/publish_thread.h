#pragma once
// PublishThread: releases each result at mid-exposure + declared latency to all publishers, and sends health and
// previews in between. The only thread that waits for sockets; nobody waits for it. What it did it tells by samples,
// which the health keeper collects. Built before vision, destroyed after it; pending results are still released at the
// end when their moment is near. Thread-safe: the mailboxes' and rings' other ends only.

#include <functional>
#include <stop_token>
#include <thread>
#include <vector>

#include "core/base/mailbox.h"
#include "core/base/spsc_ring.h"
#include "drivers/capture_clock.h"
#include "services/health_report.h"
#include "services/result_ring.h"
#include "services/service_settings.h"

namespace pelorus {

// One released result, for health and log.
struct ReleaseSample {
  std::uint64_t seq = 0;
  Timestamp capture_time;
  Duration latency{};  // mid-exposure to release
  Duration late{};     // release against the declared moment
  std::int32_t step_us = 0;
  float sigma_px = 0;
  int reset_counter = 0;
  VisionState state = VisionState::init;
  StateReason reason = StateReason::none;
  bool deadline_missed = false;
  bool has_picture = true;
};

// What reaches the publish thread, and what comes back. Owned by the application; outlives the threads.
struct PublishDesk {
  Wake wake;
  ResultRing results{16, wake};
  Mailbox<HealthReport> health;           // from the main thread
  Mailbox<PreviewPicture> previews;       // from the preview thread
  SpscRing<ReleaseSample> samples{4096};  // to the main thread
};

class PublishThread {
 public:
  PublishThread(PublishDesk& desk, std::vector<Publisher*> publishers, const TimingConfig& config,
                const CaptureClock& clock, std::function<void()> on_thread_start = {});

  // Advances with each turn of the thread, at least ten times a second: for the watchdog.
  [[nodiscard]] std::uint64_t turns() const { return turns_.value(); }

 private:
  void run(const std::stop_token& stop);
  // Time until the next result is due; releases those that are.
  [[nodiscard]] Duration release_due();
  void release(Publication& publication);
  void send_asides();

  PublishDesk& desk_;
  std::vector<Publisher*> publishers_;
  TimingConfig config_;
  const CaptureClock& clock_;
  Counter turns_;
  std::jthread thread_;  // last: everything above is ready when it starts
};

}  // namespace pelorus
