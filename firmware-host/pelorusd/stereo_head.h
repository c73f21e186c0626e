#pragma once
// StereoHead: the camera or cameras that the configuration names, each with its ring and capture thread, and their
// pairs. Made in two steps: prepare() finds out what must be known before any thread runs (calibration; errors end the
// start), start() builds the capture threads. Owned by the application; destroyed after vision.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/stereo_calibration.h"
#include "drivers/capture_clock.h"
#include "drivers/stereo_sync.h"
#include "firmware-host/runtime/service_config.h"
#include "services/capture.h"

namespace pelorus {

class StereoHead {
 public:
  // Errors: no such source, unreadable calibration. A camera that is merely absent is none: it may come.
  [[nodiscard]] static Result<std::unique_ptr<StereoHead>> prepare(const ServiceConfig& config,
                                                                   const CaptureClock& clock);
  ~StereoHead();
  // `on_thread_start` runs first on each capture thread.
  void start(std::function<void()> on_thread_start);
  // Ends the capture threads; pairs already captured stay readable.
  void stop();

  [[nodiscard]] StereoSync& sync() { return *sync_; }
  [[nodiscard]] const StereoCalibration& calibration() const { return calibration_; }
  // Devices, not recorded or rendered pairs.
  [[nodiscard]] bool is_live() const { return live_; }
  // For the log: what was opened and what was assumed.
  [[nodiscard]] const std::string& description() const { return description_; }
  [[nodiscard]] std::vector<CaptureStatus> status() const;
  // Recorded pairs are at their end and all were taken.
  [[nodiscard]] bool exhausted() const;

 private:
  StereoHead() = default;
  [[nodiscard]] Result<> prepare_source(const SourceConfig& source, const CaptureClock& clock);
  [[nodiscard]] Result<> prepare_live(const ServiceConfig& config, const CaptureClock& clock);

  bool live_ = false;
  StereoCalibration calibration_;
  std::string description_;
  CaptureConfig capture_config_;
  std::vector<std::unique_ptr<Camera>> cameras_;  // until start()
  std::vector<std::unique_ptr<FrameRing>> rings_;
  std::unique_ptr<StereoSync> sync_;
  std::vector<std::unique_ptr<Capture>> captures_;
};

}  // namespace pelorus
