#include "firmware-host/pelorus/report/page_charts.h"

#include <algorithm>
#include <cmath>

#include "core/base/nearest_rank.h"
#include "firmware-host/pelorus/json_object.h"
#include "firmware-host/pelorus/report/body_names.h"
#include "firmware-host/pelorus/report/json_numbers.h"
#include "firmware-host/pelorus/report/latency.h"
#include "firmware-host/pelorus/report/page_scene.h"

namespace pelorus {
namespace {

constexpr int kTimeDecimals = 4;

std::size_t piece_length(std::size_t count, std::size_t limit) {
  return std::max<std::size_t>(1, (count + limit - 1) / limit);
}

// The larger of two figures of which either may be missing.
void raise(double& worst, double value) {
  if (std::isnan(worst) || value > worst) worst = value;
}

// One curve per kind of error; a gap of frames ends a line, so that nothing is drawn where nothing was measured.
std::string curves_json(const EstimatedRun& run, const std::vector<ErrorSample>& samples, std::size_t limit) {
  JsonNumbers time_s(kTimeDecimals), step_m(7), step_rad(7), absolute_m(7), absolute_rad(7);
  const std::size_t length = piece_length(samples.size(), limit);
  std::size_t last_frame = 0;
  bool has_last = false;
  for (std::size_t first = 0; first < samples.size(); first += length) {
    ErrorSample worst = samples[first];
    std::size_t end_frame = worst.frame;
    for (std::size_t i = first + 1; i < std::min(samples.size(), first + length); ++i) {
      raise(worst.step_m, samples[i].step_m);
      raise(worst.step_rad, samples[i].step_rad);
      raise(worst.absolute_m, samples[i].absolute_m);
      raise(worst.absolute_rad, samples[i].absolute_rad);
      end_frame = samples[i].frame;
    }
    const double t_s = seconds(run[worst.frame].capture_time - run.front().capture_time);
    if (has_last && worst.frame > last_frame + 1) {
      time_s.add(t_s);
      for (JsonNumbers* curve : {&step_m, &step_rad, &absolute_m, &absolute_rad}) curve->add_nulls(1);
    }
    time_s.add(t_s);
    step_m.add(worst.step_m);
    step_rad.add(worst.step_rad);
    absolute_m.add(worst.absolute_m);
    absolute_rad.add(worst.absolute_rad);
    last_frame = end_frame;
    has_last = true;
  }
  return JsonObject()
      .integer("frames_per_sample", static_cast<long long>(length))
      .raw("time_s", time_s.str())
      .raw("step_m", step_m.str())
      .raw("step_rad", step_rad.str())
      .raw("absolute_m", absolute_m.str())
      .raw("absolute_rad", absolute_rad.str())
      .str();
}

}  // namespace

std::string states_json(const EstimatedRun& run) {
  std::vector<std::string> runs;
  const auto time_s = [&run](std::size_t frame) { return seconds(run[frame].capture_time - run.front().capture_time); };
  for (std::size_t first = 0; first < run.size();) {
    std::size_t end = first + 1;
    while (end < run.size() && run[end].state == run[first].state) ++end;
    runs.push_back(JsonObject()
                       .text("state", to_text(run[first].state))
                       .text("color", css_color(state_color(run[first].state)))
                       .number("from_s", time_s(first))
                       .number("to_s", time_s(std::min(end, run.size() - 1)))
                       .integer("frames", static_cast<long long>(end - first))
                       .str());
    first = end;
  }
  return json_array(runs);
}

std::string errors_json(const ReportInput& input, const PageBudget& budget) {
  if (!input.judged.truth) return "null";
  const EstimatedRun& run = input.judged.run;
  std::vector<std::string> bodies;
  const std::size_t limit = budget.chart_samples / std::max<std::size_t>(1, input.errors.bodies.size() / 4);
  for (const BodyErrors& errors : input.errors.bodies) {
    bodies.push_back(JsonObject()
                         .text("name", body_name(input, errors))
                         .text("short_name", short_body_name(input, errors))
                         .text("true_name", true_name(input, errors))
                         .text("color", css_color(object_color(errors.samples.front().object)))
                         .raw("curves", curves_json(run, errors.samples, std::max<std::size_t>(limit, 50)))
                         .str());
  }
  return JsonObject()
      .raw("camera", curves_json(run, input.errors.camera, budget.chart_samples))
      .raw("bodies", json_array(bodies))
      .str();
}

std::string point_counts_json(const ReportInput& input, const PageBudget& budget) {
  const std::vector<PointCounts>& points = input.stages.points;
  if (points.empty()) return "null";
  JsonNumbers time_s(kTimeDecimals), tracked(1), fixed(1), moving(1), outlier(1);
  const std::size_t length = piece_length(points.size(), budget.chart_samples);
  for (std::size_t first = 0; first < points.size(); first += length) {
    const std::size_t end = std::min(points.size(), first + length);
    const auto mean = [&](int PointCounts::*which) {
      double sum = 0;
      for (std::size_t i = first; i < end; ++i) sum += points[i].*which;
      return sum / static_cast<double>(end - first);
    };
    time_s.add(seconds(points[first].capture_time - points.front().capture_time));
    tracked.add(mean(&PointCounts::tracked));
    fixed.add(mean(&PointCounts::fixed));
    moving.add(mean(&PointCounts::moving));
    outlier.add(mean(&PointCounts::outlier));
  }
  return JsonObject()
      .integer("frames_per_sample", static_cast<long long>(length))
      .raw("time_s", time_s.str())
      .raw("tracked", tracked.str())
      .raw("static", fixed.str())
      .raw("moving", moving.str())
      .raw("outlier", outlier.str())
      .str();
}

std::string stages_json(const StageRecord& stages) {
  std::vector<std::string> rows;
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    JsonObject outcomes;
    for (std::size_t i = 0; i < kOutcomeCount; ++i) {
      outcomes.integer(to_text(static_cast<StageOutcome>(i)), stages.outcomes[stage][i]);
    }
    JsonObject row;
    row.text("name", to_text(static_cast<Stage>(stage))).raw("outcomes", outcomes.str());
    std::vector<double> times_ms = stages.stage_ms[stage];
    std::sort(times_ms.begin(), times_ms.end());
    const auto quantile = [&times_ms](double share) { return nearest_rank(times_ms, share); };
    row.number("p50_ms", quantile(0.5)).number("p99_ms", quantile(0.99)).number("max_ms", quantile(1.0));
    rows.push_back(row.str());
  }
  return json_array(rows);
}

std::string latency_json(const StageRecord& stages) {
  const LatencyHistogram histogram = latency_histogram(stages.latency_ms);
  if (histogram.frames == 0) return "null";
  std::vector<std::string> bins;
  for (const LatencyBin& bin : histogram.bins) {
    bins.push_back(JsonNumbers(6).add(bin.low_ms).add(bin.high_ms).add(static_cast<double>(bin.frames)).str());
  }
  return JsonObject()
      .raw("bins", json_array(bins))
      .integer("frames", histogram.frames)
      .number("mean_ms", histogram.mean_ms)
      .number("p50_ms", histogram.p50_ms)
      .number("p99_ms", histogram.p99_ms)
      .number("p999_ms", histogram.p999_ms)
      .number("max_ms", histogram.max_ms)
      .str();
}

std::string pictures_json(const ReportInput& input, const PageBudget& budget) {
  const EstimatedRun& run = input.judged.run;
  const std::vector<Thumbnail>& all = input.thumbnails.pictures;
  std::vector<std::string> pictures;
  const std::size_t count = std::min(budget.pictures, all.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Thumbnail& picture = all[count == 1 ? 0 : i * (all.size() - 1) / (count - 1)];
    const auto frame = std::find_if(run.begin(), run.end(), [&](const auto& f) { return f.seq == picture.seq; });
    if (frame == run.end()) continue;  // of another run
    pictures.push_back(JsonObject()
                           .integer("seq", static_cast<long long>(picture.seq))
                           .number("time_s", seconds(frame->capture_time - run.front().capture_time))
                           .text("src", picture.data_uri)
                           .str());
  }
  return json_array(pictures);
}

}  // namespace pelorus
