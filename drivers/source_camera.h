#pragma once
// SourceCamera: any StereoSource (recorded data, the synthetic world) as a live Camera of two views: each pair comes
// at its time, stamped on the capture clock. The pace is that of the recording or a given rate. A source too slow for
// it (decoding, rendering) makes the time of its world wait; that is counted, no pair is lost by it.

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "core/base/counter.h"
#include "drivers/camera.h"
#include "drivers/capture_clock.h"
#include "drivers/stereo_source.h"

namespace pelorus {

struct PaceConfig {
  double rate_hz = 0;   // 0 = as the pairs' time stamps say
  bool repeat = false;  // start anew at the end; else the outcome is `ended`
};

class SourceCamera final : public Camera {
 public:
  // `open_source` is called by open() and, when repeating, at each end. `clock` is borrowed.
  using OpenSource = std::function<Result<std::unique_ptr<StereoSource>>()>;
  SourceCamera(OpenSource open_source, const PaceConfig& config, const CaptureClock& clock);

  [[nodiscard]] Result<> open() override;
  [[nodiscard]] Result<> start() override;
  [[nodiscard]] FrameOutcome next(CameraFrame& frame, Duration timeout) override;
  void stop() override {}
  [[nodiscard]] FrameFormat format() const override;
  [[nodiscard]] CameraStatistics statistics() const override;
  [[nodiscard]] std::string description() const override;

  // Null before open().
  [[nodiscard]] const StereoSource* source() const { return source_.get(); }
  // Pairs that came late because the source was too slow.
  [[nodiscard]] std::uint64_t late() const { return late_.value(); }

 private:
  [[nodiscard]] std::optional<FrameOutcome> read_ahead();
  void schedule();
  void deliver(CameraFrame& frame);

  OpenSource open_source_;
  PaceConfig config_;
  const CaptureClock& clock_;
  std::unique_ptr<StereoSource> source_;
  SourcePair ahead_;  // read before it is due
  bool have_ahead_ = false;
  bool first_of_run_ = true;
  Timestamp due_;          // of ahead_, on the capture clock
  Timestamp recorded_;     // stamp of ahead_ in the source
  std::uint64_t seq_ = 0;  // of ahead_, growing over repetitions
  std::uint64_t seq_in_source_ = 0;
  CameraCounters counters_;
  Counter late_;
};

}  // namespace pelorus
