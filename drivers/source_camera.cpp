#include "drivers/source_camera.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

namespace pelorus {
namespace {

constexpr Duration kUnknownPeriod = std::chrono::milliseconds(50);  // between repetitions of a single pair
constexpr Duration kTolerated = std::chrono::milliseconds(5);       // a pair this late is still in time

}  // namespace

SourceCamera::SourceCamera(OpenSource open_source, const PaceConfig& config, const CaptureClock& clock)
    : open_source_(std::move(open_source)), config_(config), clock_(clock) {}

Result<> SourceCamera::open() {
  Result<std::unique_ptr<StereoSource>> opened = open_source_();
  if (!opened) return opened.error();
  source_ = std::move(opened.value());
  have_ahead_ = false;
  first_of_run_ = true;
  counters_.opened.add();
  return Ok{};
}

Result<> SourceCamera::start() {
  due_ = clock_.now();
  return Ok{};
}

FrameFormat SourceCamera::format() const {
  const CameraIntrinsics& left = source_->calibration().left;
  return {left.width, left.height, 2};
}

FrameOutcome SourceCamera::next(CameraFrame& frame, Duration timeout) {
  const Timestamp deadline = clock_.now() + timeout;
  if (!have_ahead_) {
    if (const std::optional<FrameOutcome> nothing = read_ahead()) return *nothing;
  }
  const Timestamp until = std::min(due_, deadline);
  if (const Duration left = until - clock_.now(); left > Duration::zero()) std::this_thread::sleep_for(left);
  if (due_ > deadline) {
    counters_.timeouts.add();
    return FrameOutcome::timeout;
  }
  deliver(frame);
  return FrameOutcome::frame;
}

// Reads the next pair before it is due. An outcome when there is none.
std::optional<FrameOutcome> SourceCamera::read_ahead() {
  const Result<bool> read = source_->next(ahead_);
  if (!read) {
    counters_.note_unnumbered();
    return FrameOutcome::dropped;
  }
  if (!read.value()) {
    // A source without a single pair is at its end however often it is repeated.
    if (!config_.repeat || first_of_run_) return FrameOutcome::ended;
    Result<std::unique_ptr<StereoSource>> again = open_source_();
    if (!again) return FrameOutcome::ended;
    source_ = std::move(again.value());
    first_of_run_ = true;
    return read_ahead();
  }
  schedule();
  have_ahead_ = true;
  return std::nullopt;
}

void SourceCamera::schedule() {
  const std::uint64_t step = first_of_run_ ? 1 : ahead_.seq - seq_in_source_;
  Duration pause = ahead_.capture_time - recorded_;
  if (config_.rate_hz > 0) pause = Duration(std::llround(static_cast<double>(step) * 1e9 / config_.rate_hz));
  const bool very_first = seq_ == 0;
  if (first_of_run_ && config_.rate_hz <= 0) pause = very_first ? Duration::zero() : kUnknownPeriod;
  counters_.note_gap(step - 1);
  seq_ += step;
  seq_in_source_ = ahead_.seq;
  recorded_ = ahead_.capture_time;
  first_of_run_ = false;
  due_ = due_ + pause;
  const Timestamp now = clock_.now();
  if (now <= due_ + kTolerated) return;
  if (!very_first) late_.add();
  due_ = now;
}

void SourceCamera::deliver(CameraFrame& frame) {
  // The images change places: no copy, and the slot's storage serves the next reading.
  std::swap(frame.view[0], ahead_.left);
  std::swap(frame.view[1], ahead_.right);
  frame.views = 2;
  frame.seq = seq_;
  frame.mid_exposure = due_;
  frame.arrival = clock_.now();
  frame.exposure = Duration::zero();
  frame.time_source = TimeSource::hardware;
  have_ahead_ = false;
  counters_.frames.add();
}

CameraStatistics SourceCamera::statistics() const { return counters_.read(); }

std::string SourceCamera::description() const { return source_->description(); }

}  // namespace pelorus
