#include "firmware-host/pelorus/bench/latency_report.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "core/base/nearest_rank.h"
#include "firmware-host/pelorus/bench/allocation_counter.h"
#include "firmware-host/pelorus/json_object.h"

namespace pelorus {
namespace {

constexpr std::array<double, 5> kShares{0, 0.5, 0.99, 0.999, 1};
constexpr std::array<const char*, 5> kShareNames{"min", "p50", "p99", "p99.9", "max"};

struct Counts {
  long long missed = 0;
  long long without_pose = 0;
  long long degraded = 0;
  std::array<long long, 3> shed{};
  double mean_points = 0;
  double mean_objects = 0;
};

Counts count(const LatencyRun& run) {
  Counts c;
  for (const ReleasedStep& step : run.steps) {
    c.missed += step.deadline_missed;
    c.without_pose += !step.pose_valid;
    c.degraded += step.state == VisionState::degraded;
    ++c.shed[static_cast<std::size_t>(step.report.shed)];
    c.mean_points += step.report.points_tracked;
    c.mean_objects += step.objects;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(1, run.steps.size()));
  c.mean_points /= n;
  c.mean_objects /= n;
  return c;
}

template <class Value>
Distribution distribution(const char* name, const char* unit, const LatencyRun& run, Value value) {
  Distribution d{name, unit, {}};
  d.values.reserve(run.steps.size());
  for (const ReleasedStep& step : run.steps) d.values.push_back(value(step));
  std::sort(d.values.begin(), d.values.end());
  return d;
}

template <class... Arguments>
void add(std::string& text, const char* format, Arguments... arguments) {
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(), format, arguments...);
  text += line.data();
}

double cpu_ms_per_step(const LatencyRun& run) {
  double sum = 0;
  for (const ThreadCost& thread : run.threads) sum += thread.cpu_ms;
  return sum / static_cast<double>(std::max<std::size_t>(1, run.steps.size()));
}

std::string allocations_text(const LatencyRun& run) {
  return allocations_are_counted() ? std::to_string(run.allocations) : "not counted in this build";
}

std::string faults_by_thread(const LatencyRun& run) {
  std::string text;
  for (const ThreadCost& thread : run.threads) text += " " + thread.name + " " + std::to_string(thread.page_faults);
  return text;
}

}  // namespace

double Distribution::at(double share) const { return nearest_rank(values, share); }

std::vector<Distribution> distributions(const LatencyRun& run) {
  std::vector<Distribution> all;
  for (std::size_t s = 0; s < kStageCount; ++s) {
    all.push_back(distribution(to_text(static_cast<Stage>(s)), "ms", run,
                               [s](const ReleasedStep& step) { return 1e-3 * step.report.stages[s].microseconds; }));
  }
  all.push_back(
      distribution("step", "ms", run, [](const ReleasedStep& step) { return 1e-3 * step.report.step_microseconds; }));
  all.push_back(distribution("exposure to ready", "ms", run, [](const ReleasedStep& s) { return s.ready_ms; }));
  all.push_back(distribution("exposure to release", "ms", run, [](const ReleasedStep& s) { return s.released_ms; }));
  all.push_back(distribution("release after due", "us", run, [](const ReleasedStep& s) { return s.late_us; }));
  return all;
}

std::string latency_table(const LatencyContext& context, const LatencyRun& run) {
  const Counts c = count(run);
  std::string text;
  add(text, "%s, %dx%d, %.4g Hz, %.1f s counted, %zu results, %.0f points and %.1f objects on average\n",
      context.dataset.c_str(), context.width, context.height, context.options.rate_hz, run.seconds, run.steps.size(),
      c.mean_points, c.mean_objects);
  add(text, "host wakes a thread late by: p50 %.0f us, p99 %.0f us, p99.9 %.0f us, max %.0f us%s\n",
      context.host.percentile_us(0.5), context.host.percentile_us(0.99), context.host.percentile_us(0.999),
      context.host.percentile_us(1), context.host.realtime ? " (real-time class)" : " (normal class)");
  for (const std::string& refusal : run.refused) text += "not granted: " + refusal + "\n";
  text += "\n";
  add(text, "%-22s", "");
  for (const char* name : kShareNames) add(text, "%10s", name);
  text += "\n";
  for (const Distribution& d : distributions(run)) {
    add(text, "%-19s %s", d.name.c_str(), d.unit.c_str());
    for (const double share : kShares) add(text, "%10.2f", d.at(share));
    text += "\n";
  }
  add(text, "\ndeadlines missed       %lld of %zu (declared %.4g ms, tolerance %.4g ms)\n", c.missed, run.steps.size(),
      context.options.config.timing.latency_ms, context.options.config.timing.deadline_tolerance_ms);
  add(text, "steps that shed work   %lld new points, %lld objects' windows too\n", c.shed[1], c.shed[2]);
  add(text, "pairs not stepped      %llu passed over for newer ones, %llu results dropped, %llu fed late\n",
      static_cast<unsigned long long>(run.pairs_superseded), static_cast<unsigned long long>(run.results_dropped),
      static_cast<unsigned long long>(run.pairs_late));
  add(text, "results without pose   %lld, degraded %lld\n", c.without_pose, c.degraded);
  add(text, "heap allocations       %s\n", allocations_text(run).c_str());
  add(text, "page faults            %llu minor, %llu major:%s\n", static_cast<unsigned long long>(run.minor_faults),
      static_cast<unsigned long long>(run.major_faults), faults_by_thread(run).c_str());
  add(text, "resident memory        %.0f MB at first, %.0f MB in the end, %.0f MB at most (held pictures left out)\n",
      run.rss_start_mb, run.rss_end_mb, run.rss_peak_mb);
  add(text, "processor time         %.2f ms per result over all threads:", cpu_ms_per_step(run));
  for (const ThreadCost& thread : run.threads) {
    const double each = thread.cpu_ms / static_cast<double>(std::max<std::size_t>(1, run.steps.size()));
    if (each >= 0.005) add(text, " %s %.2f", thread.name.c_str(), each);
  }
  text += "\n";
  return text;
}

std::string latency_json(const LatencyContext& context, const LatencyRun& run) {
  const Counts c = count(run);
  JsonObject host;
  for (std::size_t i = 0; i < kShares.size(); ++i) {
    host.number(std::string(kShareNames[i]) + "_us", context.host.percentile_us(kShares[i]));
  }
  host.flag("realtime", context.host.realtime);
  JsonObject spread;
  for (const Distribution& d : distributions(run)) {
    JsonObject one;
    one.text("unit", d.unit);
    for (std::size_t i = 0; i < kShares.size(); ++i) one.number(kShareNames[i], d.at(kShares[i]));
    spread.raw(d.name, one.str());
  }
  JsonObject threads;
  JsonObject faults;
  for (const ThreadCost& thread : run.threads) {
    threads.number(thread.name, thread.cpu_ms);
    faults.integer(thread.name, static_cast<long long>(thread.page_faults));
  }
  std::vector<std::string> refused;
  for (const std::string& refusal : run.refused) refused.push_back(JsonObject().text("refused", refusal).str());
  JsonObject json;
  json.text("dataset", context.dataset)
      .integer("width_px", context.width)
      .integer("height_px", context.height)
      .number("rate_hz", context.options.rate_hz)
      .number("seconds", run.seconds)
      .integer("results", static_cast<long long>(run.steps.size()))
      .number("points_mean", c.mean_points)
      .number("objects_mean", c.mean_objects)
      .number("latency_declared_ms", context.options.config.timing.latency_ms)
      .raw("host_wakeup", host.str())
      .raw("not_granted", json_array(refused))
      .raw("distributions", spread.str())
      .integer("deadlines_missed", c.missed)
      .integer("shed_refill", c.shed[1])
      .integer("shed_object_window", c.shed[2])
      .integer("pairs_superseded", static_cast<long long>(run.pairs_superseded))
      .integer("pairs_fed_late", static_cast<long long>(run.pairs_late))
      .integer("results_dropped", static_cast<long long>(run.results_dropped))
      .integer("results_without_pose", c.without_pose)
      .integer("page_faults_minor", static_cast<long long>(run.minor_faults))
      .integer("page_faults_major", static_cast<long long>(run.major_faults))
      .raw("page_faults_by_thread", faults.str())
      .number("rss_start_mb", run.rss_start_mb)
      .number("rss_end_mb", run.rss_end_mb)
      .number("rss_peak_mb", run.rss_peak_mb)
      .number("cpu_ms_per_result", cpu_ms_per_step(run))
      .raw("cpu_ms_by_thread", threads.str());
  if (allocations_are_counted()) {
    json.integer("allocations", static_cast<long long>(run.allocations));
  } else {
    json.raw("allocations", "null");
  }
  return json.str();
}

}  // namespace pelorus
