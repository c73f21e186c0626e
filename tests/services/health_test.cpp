#include "services/health.h"

#include <gtest/gtest.h>

#include "services/host_facts.h"

namespace pelorus {
namespace {

ReleaseSample sample_of(int i) {
  ReleaseSample s;
  s.seq = static_cast<std::uint64_t>(i);
  s.capture_time = Timestamp{1'000'000'000 + i * std::int64_t{50'000'000}};
  s.latency = std::chrono::milliseconds(80);
  s.step_us = 10000;
  s.state = VisionState::tracking;
  return s;
}

TEST(Health, TellsRatesAndLatenciesOfThePeriodOnly) {
  Health health;
  HealthReport report;
  health.report(Timestamp{1'000'000'000}, report);
  for (int i = 1; i <= 100; ++i) {
    ReleaseSample s = sample_of(i);
    s.latency = std::chrono::milliseconds(i);
    s.late = std::chrono::microseconds(i);
    health.add(s);
  }
  health.report(Timestamp{6'000'000'000}, report);
  EXPECT_NEAR(report.timing.pairs_rate_hz, 20, 1e-9);
  EXPECT_NEAR(report.timing.latency_p50_ms, 50, 1e-9);
  EXPECT_NEAR(report.timing.latency_p99_ms, 99, 1e-9);
  EXPECT_NEAR(report.timing.latency_max_ms, 100, 1e-9);
  EXPECT_NEAR(report.timing.release_jitter_ms, 0.099, 1e-9);
  EXPECT_NEAR(report.timing.interval_max_ms, 50, 1e-9);
  EXPECT_NEAR(report.timing.interval_jitter_ms, 0, 1e-9);
  EXPECT_NEAR(report.timing.step_max_ms, 10, 1e-9);
  health.report(Timestamp{7'000'000'000}, report);
  EXPECT_EQ(report.timing.pairs_rate_hz, 0);
  EXPECT_TRUE(std::isnan(report.timing.latency_max_ms)) << "nothing happened: nothing is known";
  EXPECT_EQ(report.counters.results_published, 100U);
}

// Between two regular reports: what is new is told, what is measured over a period stays as it was and goes on.
TEST(Health, AReportInBetweenTakesNothingFromThePeriod) {
  Health health;
  HealthReport report;
  health.report(Timestamp{1'000'000'000}, report);
  for (int i = 1; i <= 10; ++i) health.add(sample_of(i));
  health.report(Timestamp{2'000'000'000}, report);
  for (int i = 11; i <= 15; ++i) health.add(sample_of(i));
  HealthReport between;
  health.report_again(Timestamp{2'250'000'000}, between);
  EXPECT_EQ(between.time.ns, 2'250'000'000);
  EXPECT_EQ(between.counters.results_published, 15U);
  EXPECT_NEAR(between.timing.pairs_rate_hz, 10, 1e-9);
  for (int i = 16; i <= 30; ++i) health.add(sample_of(i));
  health.report(Timestamp{3'000'000'000}, report);
  EXPECT_NEAR(report.timing.pairs_rate_hz, 20, 1e-9);
}

TEST(Health, CountsMissesAndKeepsTheLastState) {
  Health health;
  ReleaseSample s = sample_of(1);
  health.add(s);
  s.deadline_missed = true;
  s.state = VisionState::lost;
  s.reason = StateReason::few_points;
  s.reset_counter = 2;
  health.add(s);
  HealthReport report;
  health.report(Timestamp{2'000'000'000}, report);
  EXPECT_EQ(report.state, VisionState::lost);
  EXPECT_EQ(report.reason, StateReason::few_points);
  EXPECT_EQ(report.counters.deadline_misses, 1U);
  EXPECT_EQ(report.counters.losses_of_track, 2U);
}

TEST(Health, ResultsWithoutPicturesCountAsResultsOnly) {
  Health health;
  HealthReport report;
  health.report(Timestamp{1'000'000'000}, report);
  ReleaseSample s = sample_of(1);
  s.has_picture = false;
  health.add(s);
  health.report(Timestamp{2'000'000'000}, report);
  EXPECT_EQ(report.timing.results_rate_hz, 1);
  EXPECT_EQ(report.timing.pairs_rate_hz, 0);
  EXPECT_TRUE(std::isnan(report.timing.latency_p50_ms));
}

TEST(HostFacts, SeesItsOwnWorkAndMemory) {
  HostFacts facts("/");
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
  while (std::chrono::steady_clock::now() < end) {
  }
  const HostReport report = facts.read();
  EXPECT_GT(report.cpu_percent, 5);
  EXPECT_GT(report.memory_mb, 1);
  EXPECT_GT(report.disk_free_gb, 0);
  EXPECT_TRUE(std::isnan(HostFacts("").read().disk_free_gb));
}

}  // namespace
}  // namespace pelorus
