#pragma once
// Health: what happened since the last report, gathered from the publish thread's samples, and the totals since the
// start. Bounded memory: the latest 4096 results of a reporting period. Thread-bound to the main thread.

#include <cstdint>
#include <vector>

#include "services/health_report.h"
#include "services/publish_thread.h"

namespace pelorus {

class Health {
 public:
  Health();

  void add(const ReleaseSample& sample);
  // Fills timing, state, and the counters that follow from samples; what was added is then forgotten, totals are not.
  void report(Timestamp now, HealthReport& report);
  // Between two of those: state and totals as they are now, timing as it was reported last.
  void report_again(Timestamp now, HealthReport& report) const;

  [[nodiscard]] VisionState state() const { return state_; }
  [[nodiscard]] StateReason reason() const { return reason_; }
  [[nodiscard]] std::uint64_t results() const { return results_; }

 private:
  [[nodiscard]] TimingReport timing(double period_s);

  std::vector<double> latency_ms_, late_ms_, step_ms_, interval_ms_;
  std::uint64_t period_results_ = 0;
  std::uint64_t period_pairs_ = 0;
  Timestamp last_report_;
  bool any_pair_ = false;
  Timestamp last_capture_;
  VisionState state_ = VisionState::init;
  StateReason reason_ = StateReason::starting;
  double sigma_px_ = kUnknown;
  std::uint64_t results_ = 0;
  std::uint64_t deadline_misses_ = 0;
  int reset_counter_ = 0;
  TimingReport last_timing_;
};

}  // namespace pelorus
