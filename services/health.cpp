#include "services/health.h"

#include <algorithm>

#include "core/base/nearest_rank.h"

namespace pelorus {
namespace {

constexpr std::size_t kMostSamples = 4096;

void keep(std::vector<double>& values, double value) {
  if (values.size() < kMostSamples) values.push_back(value);
}

// Sorts.
double quantile(std::vector<double>& values, double share) {
  std::sort(values.begin(), values.end());
  return nearest_rank(values, share);
}

}  // namespace

Health::Health() {
  for (std::vector<double>* values : {&latency_ms_, &late_ms_, &step_ms_, &interval_ms_}) values->reserve(kMostSamples);
}

void Health::add(const ReleaseSample& sample) {
  ++results_;
  ++period_results_;
  deadline_misses_ += sample.deadline_missed ? 1 : 0;
  reset_counter_ = sample.reset_counter;
  state_ = sample.state;
  reason_ = sample.reason;
  keep(late_ms_, 1e3 * seconds(sample.late));
  if (!sample.has_picture) return;
  ++period_pairs_;
  keep(latency_ms_, 1e3 * seconds(sample.latency));
  if (sample.step_us > 0) {
    keep(step_ms_, 1e-3 * sample.step_us);
    sigma_px_ = static_cast<double>(sample.sigma_px);
  }
  if (any_pair_) keep(interval_ms_, 1e3 * seconds(sample.capture_time - last_capture_));
  last_capture_ = sample.capture_time;
  any_pair_ = true;
}

TimingReport Health::timing(double period_s) {
  TimingReport t;
  if (period_s > 0) {
    t.pairs_rate_hz = static_cast<double>(period_pairs_) / period_s;
    t.results_rate_hz = static_cast<double>(period_results_) / period_s;
  }
  t.latency_p50_ms = quantile(latency_ms_, 0.5);
  t.latency_p99_ms = quantile(latency_ms_, 0.99);
  t.latency_max_ms = quantile(latency_ms_, 1.0);
  t.step_p50_ms = quantile(step_ms_, 0.5);
  t.step_max_ms = quantile(step_ms_, 1.0);
  t.interval_max_ms = quantile(interval_ms_, 1.0);
  if (!interval_ms_.empty()) t.interval_jitter_ms = t.interval_max_ms - interval_ms_.front();
  const double latest = quantile(late_ms_, 1.0);
  if (!late_ms_.empty()) t.release_jitter_ms = latest - late_ms_.front();
  return t;
}

void Health::report(Timestamp now, HealthReport& report) {
  const bool first = last_report_ == Timestamp{};
  last_timing_ = timing(first ? 0 : seconds(now - last_report_));
  report_again(now, report);
  last_report_ = now;
  period_results_ = 0;
  period_pairs_ = 0;
  for (std::vector<double>* values : {&latency_ms_, &late_ms_, &step_ms_, &interval_ms_}) values->clear();
}

void Health::report_again(Timestamp now, HealthReport& report) const {
  report.time = now;
  report.state = state_;
  report.reason = reason_;
  report.timing = last_timing_;
  report.picture.sigma_px = sigma_px_;
  report.counters.results_published = results_;
  report.counters.deadline_misses = deadline_misses_;
  report.counters.losses_of_track = static_cast<std::uint64_t>(std::max(0, reset_counter_));
}

}  // namespace pelorus
