#pragma once
// Estimates sent by the service's encoder into the autopilot's C99 receiver.

#include <functional>

#include "firmware-host/autopilot/pelorus_can.h"
#include "services/can/contract_text.h"

namespace pelorus::test {

inline constexpr std::uint64_t kSetInterval_us = 50'000;

inline pelorus_can_event receive(pelorus_can_receiver& rx, const CanFrame& frame, std::uint64_t now_us) {
  return pelorus_can_receive(&rx, frame.id, frame.bytes.data(), frame.size, now_us);
}

// A steady estimate with every field told.
inline CanEstimate steady_estimate() { return contract_vectors().front().estimate; }

class Link {
 public:
  explicit Link(CanTransport transport = CanTransport::classic,
                const std::function<void(pelorus_can_config&)>& change = {})
      : transport_(transport) {
    pelorus_can_config config = pelorus_can_default_config();
    config.fd = transport == CanTransport::fd;
    if (change) change(config);
    pelorus_can_start(&rx, &config);
  }

  // All frames of an estimate, at one moment; returns what the last one did.
  pelorus_can_event send(const CanEstimate& estimate, unsigned number, bool with_slow = false) {
    pelorus_can_event last = PELORUS_CAN_NOT_OURS;
    const CanSet set = encode_set(estimate, {transport_, kCanDefaultBaseId, number, with_slow});
    for (const CanFrame& frame : set) last = receive(rx, frame, now_us);
    return last;
  }
  // The next estimate, one interval later.
  pelorus_can_event send_next(const CanEstimate& estimate, bool with_slow = false) {
    now_us += kSetInterval_us;
    return send(estimate, ++counter, with_slow);
  }
  void bring_up() {
    for (int i = 0; i < 4; ++i) (void)send_next(steady_estimate());
  }
  const pelorus_can_estimate* latest() { return pelorus_can_latest(&rx, now_us); }

  pelorus_can_receiver rx{};
  std::uint64_t now_us = 1'000'000;
  unsigned counter = 0;

 private:
  CanTransport transport_;
};

}  // namespace pelorus::test
