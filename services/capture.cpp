#include "services/capture.h"

#include <algorithm>
#include <chrono>

namespace pelorus {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(50);  // longest wait between two looks at the stop request

Duration duration(double seconds) { return Duration(static_cast<std::int64_t>(seconds * 1e9)); }

}  // namespace

Duration reopen_limit(double least_s, double rate_hz, Duration interval) {
  constexpr double kPeriods = 6;
  const double stated_s = rate_hz > 0 ? 1 / rate_hz : 0;
  return duration(std::max(least_s, kPeriods * std::max(stated_s, seconds(interval))));
}

const char* text(CaptureState state) {
  switch (state) {
    case CaptureState::opening:
      return "opening";
    case CaptureState::streaming:
      return "streaming";
    case CaptureState::silent:
      return "silent";
    case CaptureState::lost:
      return "lost";
    case CaptureState::ended:
      return "ended";
  }
  return "unknown";
}

Capture::Capture(std::unique_ptr<Camera> camera, FrameRing& ring, const CaptureConfig& config,
                 std::function<void()> on_thread_start)
    : camera_(std::move(camera)),
      ring_(ring),
      config_(config),
      thread_([this, prepare = std::move(on_thread_start)](const std::stop_token& stop) {
        if (prepare) prepare();
        run(stop);
      }) {}

CaptureStatus Capture::status() const {
  CaptureStatus status;
  status.state = state_.load(std::memory_order_relaxed);
  status.camera = camera_->statistics();
  status.ring = ring_.drops();
  status.last_frame.ns = last_frame_ns_.load(std::memory_order_relaxed);
  const std::scoped_lock lock(text_mutex_);
  status.description = description_;
  status.last_problem = last_problem_;
  return status;
}

void Capture::run(const std::stop_token& stop) {
  double retry_s = config_.retry_first_s;
  while (!stop.stop_requested() && state_ != CaptureState::ended) {
    const std::uint64_t frames_before = camera_->statistics().frames;
    if (open_camera()) stream(stop);
    camera_->stop();
    if (stop.stop_requested() || state_ == CaptureState::ended) return;
    // A camera that worked is tried again at once; one that opens and stays silent gets pauses like an absent one.
    const bool worked = camera_->statistics().frames > frames_before;
    retry_s = worked ? config_.retry_first_s : std::min(2 * retry_s, config_.retry_longest_s);
    pause(stop, retry_s);
  }
}

bool Capture::open_camera() {
  Result<> opened = camera_->open();
  if (opened) opened = camera_->start();
  const std::scoped_lock lock(text_mutex_);
  if (opened) {
    description_ = camera_->description();
    return true;
  }
  last_problem_ = opened.error().message();
  set_state(CaptureState::lost);
  return false;
}

void Capture::stream(const std::stop_token& stop) {
  auto last = std::chrono::steady_clock::now();  // usable frame
  auto last_sign = last;                         // or an unusable one: the connection stands, a new one is no cure
  bool any = false;
  while (!stop.stop_requested()) {
    const FrameOutcome outcome = camera_->next(ring_.slot(), kStep);
    const auto now = std::chrono::steady_clock::now();
    if (outcome == FrameOutcome::frame || outcome == FrameOutcome::dropped) last_sign = now;
    if (outcome == FrameOutcome::frame) {
      if (any) intervals_.add(now - last);
      any = true;
      last = now;
      note_frame();
      continue;
    }
    if (outcome == FrameOutcome::ended) return set_state(CaptureState::ended);
    if (outcome == FrameOutcome::lost) return set_state(CaptureState::lost);
    if (now - last_sign > reopen_limit(config_.reopen_after_s, camera_->rate_hz(), intervals_.value())) {
      return set_state(CaptureState::lost);
    }
    if (now - last > duration(config_.silent_after_s)) set_state(CaptureState::silent);
  }
}

void Capture::note_frame() {
  last_frame_ns_.store(ring_.slot().mid_exposure.ns, std::memory_order_relaxed);
  set_state(CaptureState::streaming);
  ring_.publish();
}

void Capture::pause(const std::stop_token& stop, double seconds) {
  std::unique_lock lock(pause_mutex_);
  pause_.wait_for(lock, stop, duration(seconds), [] { return false; });
}

}  // namespace pelorus
