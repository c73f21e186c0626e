#include "services/vision.h"

#include <algorithm>
#include <chrono>

namespace pelorus {
namespace {

constexpr Duration kLongestWait = std::chrono::milliseconds(100);  // between two looks at requests

Duration from_ms(double ms) { return Duration(static_cast<std::int64_t>(ms * 1e6)); }

}  // namespace

Vision::Vision(const VisionParts& parts, const PipelineConfig& pipeline, const CaptureWatchConfig& watch,
               const TimingConfig& timing, std::function<void()> on_thread_start)
    : parts_(parts),
      config_(pipeline),
      timing_(timing),
      frame_timeout_(watch.frame_timeout_ms),
      watch_(watch),
      pipeline_(std::make_unique<Pipeline>(pipeline, parts.rectifier.rig(), parts.workers)),
      thread_([this, prepare = std::move(on_thread_start)](const std::stop_token& stop) {
        if (prepare) prepare();
        run(stop);
      }) {}

VisionStatus Vision::status() const {
  VisionStatus status;
  status.turns = turns_.value();
  status.pairs = pairs_.value();
  status.pairs_missed = pairs_missed_.value();
  status.missing_spells = missing_spells_.value();
  status.frozen_spells = frozen_spells_.value();
  status.time_jumps = time_jumps_.value();
  status.steps_shed = steps_shed_.value();
  status.mean_grey = mean_grey_.load(std::memory_order_relaxed);
  status.contrast_grey = contrast_grey_.load(std::memory_order_relaxed);
  status.exposure_ms = exposure_ms_.load(std::memory_order_relaxed);
  return status;
}

void Vision::run(const std::stop_token& stop) {
  last_heard_ = parts_.clock.now();
  while (!stop.stop_requested()) {
    turns_.add();
    obey();
    const Duration until_missing = last_heard_ + frame_timeout_.value() - parts_.clock.now();
    const StereoPair pair = parts_.sync.newest(std::clamp(until_missing, Duration(0), kLongestWait));
    if (pair) {
      take(pair);
    } else if (parts_.clock.now() - last_heard_ >= frame_timeout_.value()) {
      tell_missing();
    }
  }
}

void Vision::obey() {
  const std::uint32_t wanted = parts_.control.resets.load(std::memory_order_relaxed);
  if (wanted == resets_obeyed_) return;
  resets_obeyed_ = wanted;
  pipeline_.reset();  // lets go of the workers
  shedding_ = LoadShedding();
  pipeline_ = std::make_unique<Pipeline>(config_, parts_.rectifier.rig(), parts_.workers);
  reset_base_ = last_reset_counter_ + 1;
  id_base_ = highest_id_;
  stepped_ = false;
}

void Vision::take(const StereoPair& pair) {
  last_heard_ = parts_.clock.now();  // before the step: silence is told by the time of the pairs, not of their work
  missing_ = false;
  const Circumstances circumstances = look(pair);
  if (parts_.recorder != nullptr) {
    parts_.recorder->offer(circumstances.capture.capture_time, pair.left(), pair.right());
  }
  Publication& publication = parts_.results.draft();
  publication = Publication{};
  publication.result.seq = seq_;
  publication.result.capture_time = circumstances.capture.capture_time;
  publication.result.reset_counter = last_reset_counter_;
  publication.pairs_dropped = pairs_missed_.value();
  const bool usable = is_usable(circumstances);
  if (usable) step(pair, circumstances.capture.capture_time, publication);
  settle_state(circumstances, publication);
  // Both are a pair without a pose; in the second, too, it is to be seen whether the sides are right by now.
  if (publication.result.state == VisionState::lost || publication.reason == StateReason::exchanged_sides) {
    show_lost(pair);
  }
  const Timestamp time = circumstances.capture.capture_time;
  if (parts_.preview != nullptr && circumstances.calibration_fits && parts_.preview->due(time)) {
    const ImageView left = usable && !parts_.rectifier.is_pass_through() ? left_.view() : pair.left();
    parts_.preview->offer(left, publication, usable ? pipeline_->points() : std::span<const PointView>{});
  }
  post(publication, time + from_ms(timing_.latency_ms));
}

void Vision::show_lost(const StereoPair& pair) {
  if (parts_.lost_pairs == nullptr || !parts_.control.lost_pair_wanted.exchange(false)) return;
  SourcePair& shown = parts_.lost_pairs->draft();
  shown.left.assign(pair.left());
  shown.right.assign(pair.right());
  (void)parts_.lost_pairs->post();
}

Circumstances Vision::look(const StereoPair& pair) {
  Circumstances c;
  pairs_.add();
  // A camera that was opened anew may count from the start again.
  const std::uint64_t step = any_pair_ && pair.seq > last_pair_seq_ ? pair.seq - last_pair_seq_ : 1;
  c.pairs_missed = any_pair_ ? step - 1 : 0;
  seq_ += step;
  last_pair_seq_ = pair.seq;
  any_pair_ = true;
  if (c.pairs_missed > 0) pairs_missed_.add(c.pairs_missed);
  c.standby = parts_.control.standby.load(std::memory_order_relaxed);
  c.sides_exchanged = parts_.control.sides_exchanged.load(std::memory_order_relaxed);
  c.capture = watch_.look(pair.capture_time, pair.arrival, pair.left(), pair.right());
  frame_timeout_.learn(c.capture.capture_time, step);
  if (c.capture.time_jumped) time_jumps_.add();
  // The driver may have replaced a stamp already, and counted it.
  const bool by_arrival = pair.first->time_source == TimeSource::arrival ||
                          (pair.second && pair.second->time_source == TimeSource::arrival);
  c.capture.time_jumped = c.capture.time_jumped || (by_arrival && stamped_);
  stamped_ = stamped_ || !by_arrival;
  if (c.capture.froze) frozen_spells_.add();
  mean_grey_.store(c.capture.mean_grey, std::memory_order_relaxed);
  contrast_grey_.store(c.capture.contrast_grey, std::memory_order_relaxed);
  exposure_ms_.store(1e3 * seconds(pair.first->exposure), std::memory_order_relaxed);
  const auto fits = [&](const ImageView& view) {
    const StereoRig& rig = parts_.rectifier.rig();  // rectified pictures keep the size of the raw ones
    return view.width == rig.width && view.height == rig.height;
  };
  c.calibration_fits = fits(pair.left()) && fits(pair.right());
  return c;
}

void Vision::step(const StereoPair& pair, Timestamp capture_time, Publication& publication) {
  StereoFrame frame{seq_, capture_time, pair.left(), pair.right()};
  if (!parts_.rectifier.is_pass_through()) {
    parts_.rectifier.apply_left(pair.left(), left_);
    parts_.rectifier.apply_right(pair.right(), right_);
    frame.left = left_.view();
    frame.right = right_.view();
  }
  FrameResult& result = publication.result;
  const Timestamp before = parts_.clock.now();
  const Shed shed = shedding_.choose(capture_time + from_ms(timing_.latency_ms) - before);
  result = pipeline_->step(frame, shed);
  shedding_.learn(shed, result.report.refilled, parts_.clock.now() - before);
  if (shed != Shed::nothing) steps_shed_.add();
  publication.step = stepped_ ? capture_time - last_stepped_ : Duration{};
  stepped_ = true;
  last_stepped_ = capture_time;
  result.reset_counter += reset_base_;
  last_reset_counter_ = result.reset_counter;
  for (int i = 0; i < result.objects_size; ++i) {
    BodyId& id = result.objects[static_cast<std::size_t>(i)].id;
    id.value += id_base_;
    highest_id_ = std::max(highest_id_, id.value);
  }
}

// Nothing to be seen: said at once and again in each further time of a time-out.
void Vision::tell_missing() {
  if (!missing_) missing_spells_.add();
  missing_ = true;
  Circumstances c;
  c.pictures = false;
  c.standby = parts_.control.standby.load(std::memory_order_relaxed);
  const Timestamp now = parts_.clock.now();
  Publication& publication = parts_.results.draft();
  publication = Publication{};
  publication.has_picture = false;
  publication.result.seq = seq_;
  publication.result.capture_time = now;
  publication.result.reset_counter = last_reset_counter_;
  publication.pairs_dropped = pairs_missed_.value();
  settle_state(c, publication);
  post(publication, now);
  last_heard_ = now;
}

// Results leave in order.
void Vision::post(Publication& publication, Timestamp release_due) {
  last_release_due_ = std::max(last_release_due_, release_due);
  publication.release_due = last_release_due_;
  publication.ready = parts_.clock.now();
  (void)parts_.results.post();
}

}  // namespace pelorus
