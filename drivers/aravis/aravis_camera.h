#pragma once
// AravisCamera: a GigE Vision camera by Aravis 0.8. Buffers are allocated before the stream starts; each received
// frame is copied (converted to gray) into the caller's slot and its buffer goes back at once. Incomplete frames are
// dropped and counted. The camera's stamps are mapped to the capture clock (device_clock.h) and moved to
// mid-exposure. Gone cameras are noticed by silence first and by Aravis' lost control after about 5 s.
// Thread rule of Camera; Aravis has receiving and heartbeat threads of its own.

#include <memory>

#include "core/base/counter.h"
#include "drivers/aravis/aravis_config.h"
#include "drivers/aravis/frame_id.h"
#include "drivers/camera.h"
#include "drivers/capture_clock.h"
#include "drivers/device_clock.h"

struct _ArvBuffer;  // Aravis' own name; its headers stay out of ours

namespace pelorus {

class AravisCamera final : public Camera {
 public:
  // `clock` is borrowed.
  AravisCamera(const AravisConfig& config, const CaptureClock& clock);
  ~AravisCamera() override;

  [[nodiscard]] Result<> open() override;
  [[nodiscard]] Result<> start() override;
  [[nodiscard]] FrameOutcome next(CameraFrame& frame, Duration timeout) override;
  void stop() override;
  [[nodiscard]] FrameFormat format() const override { return format_; }
  [[nodiscard]] CameraStatistics statistics() const override;
  [[nodiscard]] double rate_hz() const override { return rate_hz_; }
  [[nodiscard]] std::string description() const override { return description_; }

 private:
  struct Session;  // the Aravis objects of one connection
  struct Transport {
    Counter resend_requests, resent_packets, missing_packets, underruns;
  };

  [[nodiscard]] Error problem(const std::string& what, const std::string& cure) const;
  [[nodiscard]] Result<> read_back();
  [[nodiscard]] FrameOutcome take(_ArvBuffer* buffer, CameraFrame& frame);
  void stamp(_ArvBuffer* buffer, CameraFrame& frame);
  void count_transport();

  AravisConfig config_;
  const CaptureClock& clock_;
  std::unique_ptr<Session> session_;
  FrameFormat format_;
  std::string description_;
  double rate_hz_ = 0;
  DeviceClock device_clock_;
  FrameIdUnwrapper frame_ids_;
  std::uint64_t seq_ = 0;
  Timestamp last_arrival_;
  CameraCounters counters_;
  Transport transport_;  // of this connection and all before it
};

}  // namespace pelorus
