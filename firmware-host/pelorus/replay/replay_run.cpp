#include "firmware-host/pelorus/replay/replay_run.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>
#include <thread>
#include <vector>

#include "core/geometry/rectifier.h"
#include "core/pipeline/pipeline.h"
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

// Reads pairs; in real-time mode releases each at its recorded time and, when the step was late, only the newest.
class PairFeed {
 public:
  PairFeed(StereoSource& source, const ReplayOptions& options) : source_(source), options_(options) {}

  // False at the end of the data, at max_frames, or when asked to stop.
  [[nodiscard]] Result<bool> next(SourcePair& pair) {
    Result<bool> more = read(pair);
    if (!more || !more.value() || !options_.realtime) return more;
    if (!started_) {
      started_ = true;
      start_clock_ = Clock::now();
      start_time_ = pair.capture_time;
      return true;
    }
    while (is_superseded(pair)) {
      if (more = read(ahead_); !more) return more;
      if (!more.value()) return true;  // the last pair is the newest there is
      std::swap(pair, ahead_);
      ++dropped_;
    }
    wait_until(due(pair));
    return true;
  }

  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] std::uint64_t pairs_read() const { return read_; }
  [[nodiscard]] bool stopped() const { return stopped_; }
  [[nodiscard]] std::uint64_t unreadable() const { return unreadable_; }
  // Of these, the ones between readable pairs: only they are gaps in seq.
  [[nodiscard]] std::uint64_t bridged() const { return bridged_; }
  [[nodiscard]] const std::optional<Error>& first_unreadable() const { return first_unreadable_; }

 private:
  Result<bool> read(SourcePair& pair) {
    if (options_.stop && options_.stop()) stopped_ = true;
    if (stopped_ || (options_.max_frames > 0 && read_ >= options_.max_frames)) return false;
    Result<bool> more = next_readable(pair);
    if (more.ok() && more.value()) {
      ++read_;
      if (has_last_) interval_ = pair.capture_time - last_time_;
      last_time_ = pair.capture_time;
      has_last_ = true;
    }
    return more;
  }
  // A damaged image costs its pair, told and counted; more of them in a row than the method bridges end the run. Before
  // the first readable pair there is nothing to bridge.
  Result<bool> next_readable(SourcePair& pair) {
    constexpr std::uint64_t kBridgedPairs = 3;
    for (std::uint64_t in_a_row = 0;; ++in_a_row) {
      Result<bool> more = source_.next(pair);
      if (more.ok() && more.value() && read_ > 0) bridged_ += in_a_row;
      if (more.ok()) return more;
      if (!first_unreadable_) first_unreadable_ = more.error();
      if (in_a_row == kBridgedPairs && read_ > 0) return more;
      ++unreadable_;
      if (options_.warn) options_.warn(more.error());
    }
  }
  Clock::time_point due(const SourcePair& pair) const { return start_clock_ + (pair.capture_time - start_time_); }
  // Its successor, one interval later, has been captured by now.
  bool is_superseded(const SourcePair& pair) const { return Clock::now() >= due(pair) + interval_; }
  void wait_until(Clock::time_point time) const {
    constexpr auto kAskStopEvery = std::chrono::milliseconds(50);
    while (Clock::now() < time && !(options_.stop && options_.stop())) {
      std::this_thread::sleep_until(std::min(time, Clock::now() + kAskStopEvery));
    }
  }

  StereoSource& source_;
  const ReplayOptions& options_;
  SourcePair ahead_;
  bool started_ = false;
  bool stopped_ = false;
  bool has_last_ = false;
  Clock::time_point start_clock_;
  Timestamp start_time_;
  Timestamp last_time_;
  Duration interval_{0};
  std::uint64_t read_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t unreadable_ = 0;
  std::uint64_t bridged_ = 0;
  std::optional<Error> first_unreadable_;
};

class SummaryCounter {
 public:
  void count(const FrameResult& result, const FrameTiming& timing) {
    if (summary_.frames > 0 && result.seq > last_seq_ + 1) summary_.missing += result.seq - last_seq_ - 1;
    last_seq_ = result.seq;
    ++summary_.frames;
    if (!result.pose_valid) ++summary_.without_pose;
    ++summary_.states[static_cast<std::size_t>(result.state)];
    summary_.resets = result.reset_counter;
    for (const ObjectState& object : result.objects_view()) {
      if (object.phase == ObjectPhase::confirmed) confirmed_.insert(object.id);
    }
    step_us_.push_back(timing.step_us);
  }

  [[nodiscard]] ReplaySummary finish(const PairFeed& feed, std::optional<Error> failure) {
    summary_.dropped = feed.dropped();
    // A pair dropped by the feed or bridged leaves the same gap in seq as one missing from the recording.
    summary_.missing -= std::min(summary_.missing, summary_.dropped);
    summary_.unreadable = feed.unreadable();
    summary_.missing -= std::min(summary_.missing, feed.bridged());
    summary_.objects_confirmed = static_cast<int>(confirmed_.size());
    std::sort(step_us_.begin(), step_us_.end());
    summary_.median_step_ms = quantile_ms(0.5);
    summary_.p99_step_ms = quantile_ms(0.99);
    summary_.interrupted = feed.stopped();
    summary_.ended_early = failure.has_value();
    summary_.failure = failure ? std::move(failure) : feed.first_unreadable();
    return summary_;
  }

 private:
  double quantile_ms(double share) const {
    if (step_us_.empty()) return 0;
    const auto index = static_cast<std::size_t>(share * static_cast<double>(step_us_.size() - 1) + 0.5);
    return static_cast<double>(step_us_[index]) * 1e-3;
  }

  ReplaySummary summary_;
  std::uint64_t last_seq_ = 0;
  std::set<BodyId> confirmed_;
  std::vector<std::int64_t> step_us_;
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

}  // namespace

Result<ReplaySummary> run_replay(StereoSource& source, const ReplayOptions& options) {
  Result<Rectifier> rectifier = Rectifier::create(source.calibration(), "calibration");
  if (!rectifier) return rectifier.error();
  Result<ResultWriter> writer = ResultWriter::create(options.out_folder);
  if (!writer) return writer.error();
  Result<SceneWriter> scene = SceneWriter::create(options.out_folder, rectifier.value().rig());
  if (!scene) return scene.error();
  if (Result<Ok> made = make_overlay_folder(options); !made) return made.error();
  std::uint64_t total = source.pair_count();
  if (options.max_frames > 0) total = total > 0 ? std::min(total, options.max_frames) : options.max_frames;
  PairFeed feed(source, options);
  SummaryCounter counter;
  Result<Ok> outcome = run_frames(feed, options, rectifier.value(), writer.value(), scene.value(), counter, total);
  Result<Ok> finished = scene.value().finish();
  std::optional<Error> failure;
  if (!finished) failure = finished.error();
  if (!outcome) failure = outcome.error();
  return counter.finish(feed, std::move(failure));
}

std::string skipped_text(const Error& error) { return "pelorus: pair skipped: " + error.message(); }

std::string incomplete_text(const ReplaySummary& summary) {
  return "pelorus: finished, but " + pairs_text(summary.unreadable) + " of the recording could not be read";
}

std::string to_text(const ReplaySummary& summary) {
  std::array<char, 256> line{};
  std::string text;
  const auto add = [&](auto... arguments) {
    std::snprintf(line.data(), line.size(), arguments...);
    text += line.data();
  };
  using ull = unsigned long long;
  add("frames   %llu stepped, %llu missing in the recording, %llu unreadable, %llu dropped, %llu without a pose\n",
      static_cast<ull>(summary.frames), static_cast<ull>(summary.missing), static_cast<ull>(summary.unreadable),
      static_cast<ull>(summary.dropped), static_cast<ull>(summary.without_pose));
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
