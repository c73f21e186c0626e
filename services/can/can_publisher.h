#pragma once
// CanPublisher: estimates onto a CAN bus by the contract (docs/can.md). Never stale: nothing waits behind older data. A
// set that the bus has not taken when the next one comes is dropped and counted, in whole or what is left of it, and no
// set is begun while the kernel still holds frames of an older one; its AGE is that of the moment it is written. An
// interface that is absent, down or removed, at the start or later, costs a look every retry_ms and nothing else.
// Counters of estimates run on through all of it, so that receivers see the gap.
// Thread rule: publish() and tend() from the publish thread, which they never hold up; status() from any thread.
// No allocation but when an interface is opened.

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "core/base/counter.h"
#include "drivers/can/bus_health.h"
#include "drivers/can/can_socket.h"
#include "services/can/can_codec.h"
#include "services/can/can_settings.h"
#include "services/publisher.h"

namespace pelorus {

struct CanStatus {
  CanBusHealth bus;
  std::uint64_t sets_sent = 0;
  std::uint64_t sets_dropped = 0;  // an older one still waited, or the next came before it was through
  std::uint64_t sets_unheard = 0;  // there was no bus for them: no interface, or one that is down or bus-off
  std::uint64_t opened = 0;        // times the interface was opened
  std::string trouble;             // why there is no bus, empty when there is one
};

// One line for health and logs: "can0 active, 1200 sets, 0 dropped".
[[nodiscard]] std::string status_text(const CanStatus& status, const std::string& interface);

class CanPublisher final : public Publisher {
 public:
  using Clock = std::chrono::steady_clock;
  // How the socket is opened; replaced in tests by a socket pair.
  using Open = std::function<Result<CanSocket>(const CanSocketOptions&)>;

  // `calibration_hash`: 32 bits that name the calibration in force. `latency`: the declared one.
  CanPublisher(const CanConfig& config, const Rigid3& T_body_cam, Duration latency, std::uint32_t calibration_hash,
               Open open = CanSocket::open);

  void publish(const Publication& publication) override;
  // Sends what is left of a set, looks at the bus and for a lost interface; returns when it wants to be called again.
  [[nodiscard]] Duration tend() override;
  [[nodiscard]] CanStatus status() const;

 private:
  void open_if_due();
  void close(CanBusState state, const std::string& why);
  void listen();
  void begin_set();
  void send_rest();
  void drop_rest();
  void note_taken();
  void share();

  CanConfig config_;
  BodyFrames frames_;
  Open open_;
  std::uint32_t calibration_hash_;
  double latency_s_;

  std::optional<CanSocket> socket_;
  Clock::time_point next_open_{};
  PreviousPose previous_;
  unsigned counter_ = 0;

  CanEstimate estimate_;  // of the set in work
  Clock::time_point estimate_time_{};
  CanSet set_;
  int next_frame_ = 0;
  bool waiting_ = false;  // a set is in work: begun, or held back by older frames
  bool begun_ = false;

  CanStatus now_;  // of the publish thread
  mutable std::mutex mutex_;
  CanStatus shared_;  // guarded by mutex_
};

}  // namespace pelorus
