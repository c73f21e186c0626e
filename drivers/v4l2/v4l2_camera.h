#pragma once
// V4l2Camera: a V4L2 device, or a side-by-side device of two views, as a Camera. Frames are converted from kernel
// memory straight into the caller's slot and the buffer goes back at once. Buffers marked bad or short are dropped and
// counted. A stream that falls silent is restarted in place (dequeue watchdog) before the device is given up.
// Thread rule of Camera.

#include <chrono>

#include "core/base/counter.h"
#include "drivers/camera.h"
#include "drivers/capture_clock.h"
#include "drivers/v4l2/jpeg_frame.h"
#include "drivers/v4l2/v4l2_device.h"
#include "drivers/v4l2/v4l2_format.h"

namespace pelorus {

class V4l2Camera final : public Camera {
 public:
  // `clock` is borrowed.
  V4l2Camera(const V4l2Config& config, const CaptureClock& clock) : config_(config), clock_(clock) {}

  [[nodiscard]] Result<> open() override;
  [[nodiscard]] Result<> start() override;
  [[nodiscard]] FrameOutcome next(CameraFrame& frame, Duration timeout) override;
  void stop() override { device_.close(); }
  [[nodiscard]] FrameFormat format() const override;
  [[nodiscard]] CameraStatistics statistics() const override;
  [[nodiscard]] double rate_hz() const override;
  [[nodiscard]] std::string description() const override { return description_; }

 private:
  [[nodiscard]] FrameOutcome take(v4l2_buffer& buffer, CameraFrame& frame);
  [[nodiscard]] FrameOutcome wait_in_vain();
  [[nodiscard]] FrameOutcome give_up();
  [[nodiscard]] bool convert(const v4l2_buffer& buffer, CameraFrame& frame);
  void count_exposures(std::uint32_t sequence);

  V4l2Config config_;
  const CaptureClock& clock_;
  V4l2Device device_;
  JpegFrame jpeg_;
  std::string description_;
  ExposureTiming timing_;
  std::uint64_t seq_ = 0;
  bool sequence_known_ = false;
  std::uint32_t sequence_ = 0;  // of the last buffer
  std::chrono::steady_clock::time_point last_buffer_;
  CameraCounters counters_;
  Counter restarts_, time_corrections_;
};

}  // namespace pelorus
