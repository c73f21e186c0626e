#include "drivers/v4l2/v4l2_camera.h"

#include <algorithm>
#include <cmath>

namespace pelorus {
namespace {

constexpr std::uint32_t kLongestGap = 30'000;  // exposures; a longer one is a restart of the count

Duration milliseconds(double ms) { return Duration(std::llround(ms * 1e6)); }

}  // namespace

Result<> V4l2Camera::open() {
  if (Result<> opened = device_.open(config_.device); !opened) return opened;
  if (Result<> configured = device_.configure(config_); !configured) {
    device_.close();
    return configured;
  }
  const V4l2Format& f = device_.format();
  if (config_.side_by_side && f.width % 4 != 0) {  // each half must begin at an even column
    device_.close();
    return Error{ErrorCode::device, config_.device,
                 "is " + std::to_string(f.width) + " pixels wide: no two equal views",
                 "set a width that divides by four"};
  }
  timing_ = {milliseconds(f.exposure_ms), milliseconds(config_.readout_ms)};
  description_ = "V4L2 " + config_.device + " (" + device_.name() + "), " + std::to_string(f.width) + "x" +
                 std::to_string(f.height) + " " + std::string(text(f.pixels)) +
                 (config_.side_by_side ? ", two views side by side" : "") + ", " +
                 (f.rate_hz > 0 ? std::to_string(f.rate_hz).substr(0, 5) + " Hz" : "rate unknown") + ", exposure " +
                 (f.exposure_ms > 0 ? std::to_string(f.exposure_ms).substr(0, 5) + " ms" : "unknown");
  counters_.opened.add();
  return Ok{};
}

Result<> V4l2Camera::start() {
  sequence_known_ = false;
  last_buffer_ = std::chrono::steady_clock::now();
  return device_.start(config_.buffers);
}

FrameFormat V4l2Camera::format() const {
  const V4l2Format& f = device_.format();
  return config_.side_by_side ? FrameFormat{f.width / 2, f.height, 2} : FrameFormat{f.width, f.height, 1};
}

FrameOutcome V4l2Camera::next(CameraFrame& frame, Duration timeout) {
  if (!device_.streaming()) return FrameOutcome::lost;
  v4l2_buffer buffer{};
  switch (device_.dequeue(buffer, timeout)) {
    case V4l2Device::Dequeued::buffer:
      return take(buffer, frame);
    case V4l2Device::Dequeued::nothing:
      return wait_in_vain();
    case V4l2Device::Dequeued::broken:
      counters_.note_unnumbered();
      return FrameOutcome::dropped;
    case V4l2Device::Dequeued::gone:
      break;
  }
  return give_up();
}

FrameOutcome V4l2Camera::take(v4l2_buffer& buffer, CameraFrame& frame) {
  const Timestamp arrival = clock_.now();
  last_buffer_ = std::chrono::steady_clock::now();
  count_exposures(buffer.sequence);
  const bool good = (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && convert(buffer, frame);
  const FrameTime time = frame_time(buffer, timing_, clock_, arrival);
  if (!device_.give_back(buffer)) return give_up();
  if (!good) {
    counters_.incomplete.add();
    return FrameOutcome::dropped;
  }
  if (time.corrected) time_corrections_.add();
  frame.seq = seq_;
  frame.mid_exposure = time.mid_exposure;
  frame.arrival = arrival;
  frame.exposure = timing_.exposure;
  frame.time_source = time.source;
  counters_.frames.add();
  return FrameOutcome::frame;
}

bool V4l2Camera::convert(const v4l2_buffer& buffer, CameraFrame& frame) {
  RawPicture picture = device_.picture(buffer);
  if (picture.format == PixelFormat::mjpeg) {
    if (!jpeg_.decode(picture)) return false;
    picture = jpeg_.gray();
  }
  const FrameFormat wanted = format();
  frame.views = wanted.views;
  for (int i = 0; i < wanted.views; ++i) {
    if (!to_gray(picture, i * wanted.width, wanted.width, frame.view[static_cast<std::size_t>(i)])) return false;
  }
  return true;
}

void V4l2Camera::count_exposures(std::uint32_t sequence) {
  // The difference of two wrapping counts of 32 bits wraps rightly.
  const std::uint32_t since = sequence_known_ ? sequence - sequence_ : 1;
  const std::uint32_t step = since >= 1 && since <= kLongestGap ? since : 1;
  seq_ += step;
  counters_.note_gap(step - 1);
  sequence_ = sequence;
  sequence_known_ = true;
}

// The dequeue watchdog.
FrameOutcome V4l2Camera::wait_in_vain() {
  counters_.timeouts.add();
  const auto now = std::chrono::steady_clock::now();
  if (now - last_buffer_ < dequeue_limit(config_.watchdog_s, rate_hz())) return FrameOutcome::timeout;
  restarts_.add();
  device_.stop();
  if (!device_.start(config_.buffers)) return give_up();
  last_buffer_ = now;
  sequence_known_ = false;
  return FrameOutcome::timeout;
}

FrameOutcome V4l2Camera::give_up() {
  counters_.lost.add();
  device_.close();
  return FrameOutcome::lost;
}

double V4l2Camera::rate_hz() const { return device_.format().rate_hz > 0 ? device_.format().rate_hz : config_.rate_hz; }

CameraStatistics V4l2Camera::statistics() const {
  CameraStatistics s = counters_.read();
  s.restarts = restarts_.value();
  s.time_corrections = time_corrections_.value();
  return s;
}

}  // namespace pelorus
