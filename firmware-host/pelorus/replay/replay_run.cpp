#include "firmware-host/pelorus/replay/replay_run.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>
#include <vector>

#include "core/base/nearest_rank.h"
#include "core/geometry/rectifier.h"
#include "core/pipeline/pipeline.h"
#include "firmware-host/pelorus/picture_file.h"
#include "firmware-host/pelorus/replay/pair_feed.h"
#include "firmware-host/pelorus/results/incomplete_mark.h"
#include "firmware-host/pelorus/results/result_files.h"
#include "firmware-host/pelorus/results/scene_writer.h"
#include "services/overlay.h"
#include "services/side_thread.h"

namespace pelorus {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t microseconds_since(Clock::time_point start) {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start).count();
}

class SummaryCounter {
 public:
  void count(const FrameResult& result, const FrameTiming& timing) {
    ++summary_.frames;
    if (!result.pose_valid) ++summary_.without_pose;
    ++summary_.states[static_cast<std::size_t>(result.state)];
    summary_.resets = result.reset_counter;
    for (const ObjectState& object : result.objects_view()) {
      if (object.phase == ObjectPhase::confirmed) confirmed_.insert(object.id);
    }
    step_ms_.push_back(1e-3 * static_cast<double>(timing.step_us));
  }

  [[nodiscard]] ReplaySummary finish(const PairFeed& feed, std::optional<Error> failure) {
    summary_.lost = {feed.missing().count, feed.unreadable(), feed.dropped()};
    summary_.first_missing = feed.missing().first;
    summary_.objects_confirmed = static_cast<int>(confirmed_.size());
    std::sort(step_ms_.begin(), step_ms_.end());
    summary_.median_step_ms = quantile_ms(0.5);
    summary_.p99_step_ms = quantile_ms(0.99);
    summary_.interrupted = feed.stopped();
    summary_.ended_early = failure.has_value();
    summary_.broke_off = feed.broke_off();
    summary_.failure = failure ? std::move(failure) : feed.first_unreadable();
    return summary_;
  }

 private:
  double quantile_ms(double share) const { return step_ms_.empty() ? 0 : nearest_rank(step_ms_, share); }

  ReplaySummary summary_;
  std::set<BodyId> confirmed_;
  std::vector<double> step_ms_;
};

// The pair as the pipeline wants it: rectified images, which are the source's own when there is nothing to do.
class RectifiedPair {
 public:
  explicit RectifiedPair(const Rectifier& rectifier) : rectifier_(rectifier) {}

  [[nodiscard]] StereoFrame frame_of(const SourcePair& pair, FrameTiming& timing) {
    if (rectifier_.is_pass_through()) return {pair.seq, pair.capture_time, pair.left.view(), pair.right.view()};
    const Clock::time_point start = Clock::now();
    rectifier_.apply_left(pair.left.view(), left_);
    rectifier_.apply_right(pair.right.view(), right_);
    timing.rectify_us = microseconds_since(start);
    return {pair.seq, pair.capture_time, left_.view(), right_.view()};
  }

 private:
  const Rectifier& rectifier_;
  Image left_;
  Image right_;
};

Result<Ok> draw_overlay(const Overlay& overlay, const ReplayOptions& options, const StereoFrame& frame,
                        const FrameResult& result, const Pipeline& pipeline) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06llu.png", static_cast<unsigned long long>(frame.seq));
  const std::filesystem::path path = ResultPaths(options.out_folder).overlay / name.data();
  return write_picture(path, overlay.draw(frame.left, result, pipeline.points()));
}

Result<Ok> make_overlay_folder(const ReplayOptions& options) {
  if (options.overlay_every <= 0) return Ok{};
  std::error_code error;
  const std::filesystem::path folder = ResultPaths(options.out_folder).overlay;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{ErrorCode::io, folder.string(), "cannot create: " + error.message(), "check its rights"};
  return Ok{};
}

// Steps until the data end; an Error is what ended it early.
Result<Ok> run_frames(PairFeed& feed, const ReplayOptions& options, const Rectifier& rectifier, ResultWriter& writer,
                      SceneWriter& scene, SummaryCounter& counter, std::uint64_t total) {
  std::optional<PipelineThreads> threads;
  if (options.threads) threads.emplace();
  Pipeline pipeline(options.pipeline, rectifier.rig(),
                    threads ? threads->workers(!options.realtime) : PipelineWorkers{});
  Overlay overlay(rectifier.rig());
  RectifiedPair rectified(rectifier);
  SourcePair pair;
  for (std::uint64_t index = 0;; ++index) {
    FrameTiming timing;
    Clock::time_point start = Clock::now();
    Result<bool> more = feed.next(pair);
    if (!more) return more.error();
    if (!more.value()) return Ok{};
    timing.read_us = microseconds_since(start);
    const StereoFrame frame = rectified.frame_of(pair, timing);
    start = Clock::now();
    const FrameResult& result = pipeline.step(frame);
    timing.step_us = microseconds_since(start);
    counter.count(result, timing);
    if (Result<Ok> written = writer.append(result, timing); !written) return written.error();
    if (Result<Ok> written = scene.append(result, pipeline.points(), frame.left); !written) return written.error();
    overlay.observe(result);
    if (options.overlay_every > 0 && index % static_cast<std::uint64_t>(options.overlay_every) == 0) {
      if (Result<Ok> drawn = draw_overlay(overlay, options, frame, result, pipeline); !drawn) return drawn.error();
    }
    if (options.progress) options.progress(feed.pairs_read(), total);
  }
}

Result<ReplaySummary> replay_marked(StereoSource& source, const ReplayOptions& options, const Rectifier& rectifier) {
  Result<ResultWriter> writer = ResultWriter::create(options.out_folder);
  if (!writer) return writer.error();
  Result<SceneWriter> scene = SceneWriter::create(options.out_folder, rectifier.rig());
  if (!scene) return scene.error();
  if (Result<Ok> made = make_overlay_folder(options); !made) return made.error();
  std::uint64_t total = source.pair_count();
  if (options.max_frames > 0) total = total > 0 ? std::min(total, options.max_frames) : options.max_frames;
  PairFeed feed(source, options);
  SummaryCounter counter;
  Result<Ok> outcome = run_frames(feed, options, rectifier, writer.value(), scene.value(), counter, total);
  Result<Ok> finished = scene.value().finish();
  std::optional<Error> failure;
  if (!finished) failure = finished.error();
  if (!outcome) failure = outcome.error();
  ReplaySummary summary = counter.finish(feed, std::move(failure));
  const Result<> told = write_lost_pairs(options.out_folder, summary.lost);
  if (!told && !summary.ended_early) {
    summary.ended_early = true;
    summary.failure = told.error();
  }
  return summary;
}

// Why the files hold less than the whole run; empty when they hold it.
std::string early_end(const Result<ReplaySummary>& run) {
  if (!run) return run.error().message();
  const ReplaySummary& summary = run.value();
  if (summary.broke_off) return "the recording broke off: " + summary.failure->message();
  if (summary.ended_early) return summary.failure->message();
  return summary.interrupted ? "interrupted" : "";
}

}  // namespace

Result<ReplaySummary> run_replay(StereoSource& source, const ReplayOptions& options) {
  Result<Rectifier> rectifier = Rectifier::create(source.calibration(), "calibration");
  if (!rectifier) return rectifier.error();
  Result<IncompleteMark> mark = IncompleteMark::set(options.out_folder);
  if (!mark) return mark.error();
  Result<ReplaySummary> run = replay_marked(source, options, rectifier.value());
  if (const std::string reason = early_end(run); !reason.empty()) {
    mark.value().explain(reason);
  } else if (Result<> cleared = mark.value().clear(); !cleared) {
    return cleared.error();
  }
  return run;
}

bool is_incomplete(const ReplaySummary& summary) {
  return !summary.ended_early && !summary.interrupted && summary.lost.unreadable + summary.lost.missing > 0;
}

std::string skipped_text(const Error& error) { return "pelorus: pair skipped: " + error.message(); }

std::string incomplete_text(const ReplaySummary& summary) {
  std::string text = "pelorus: finished, but ";
  const LostPairs& lost = summary.lost;
  if (lost.unreadable > 0) text += pairs_text(lost.unreadable) + " of the recording could not be read";
  if (lost.missing == 0) return text;
  if (lost.unreadable > 0) text += ", and ";
  return text + pairs_text(lost.missing) + " of the recording " + (lost.missing == 1 ? "is" : "are") +
         " missing, the first at " + std::to_string(summary.first_missing.ns) + " ns";
}

std::string to_text(const ReplaySummary& summary) {
  std::array<char, 256> line{};
  std::string text;
  const auto add = [&](auto... arguments) {
    std::snprintf(line.data(), line.size(), arguments...);
    text += line.data();
  };
  using ull = unsigned long long;
  add("frames   %llu stepped, %s, %llu without a pose\n", static_cast<ull>(summary.frames),
      to_text(summary.lost).c_str(), static_cast<ull>(summary.without_pose));
  text += "states  ";
  for (std::size_t i = 0; i < summary.states.size(); ++i) {
    if (summary.states[i] == 0) continue;
    add(" %s %llu", to_text(static_cast<VisionState>(i)), static_cast<ull>(summary.states[i]));
  }
  add("   resets %d\n", summary.resets);
  add("step     median %.1f ms, p99 %.1f ms\n", summary.median_step_ms, summary.p99_step_ms);
  add("objects  %d confirmed\n", summary.objects_confirmed);
  return text;
}

}  // namespace pelorus
