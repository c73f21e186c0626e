#include "drivers/can/bus_health.h"

#include <linux/can/error.h>

namespace pelorus {
namespace {

// Newer than the headers of Debian 12's libc packages have to be: told by kernels from 6.0 on.
constexpr std::uint32_t kCountersTold = 0x00000200;  // CAN_ERR_CNT
constexpr std::uint8_t kActiveAgain = 0x40;          // CAN_ERR_CRTL_ACTIVE

void note_controller(std::uint8_t what, CanBusHealth& health) {
  if ((what & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0) ++health.overruns;
  if ((what & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
    health.state = CanBusState::passive;
  } else if ((what & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
    health.state = CanBusState::warning;
  } else if ((what & kActiveAgain) != 0) {
    health.state = CanBusState::active;
  }
}

}  // namespace

const char* to_text(CanBusState state) {
  switch (state) {
    case CanBusState::absent:
      return "absent";
    case CanBusState::down:
      return "down";
    case CanBusState::active:
      return "active";
    case CanBusState::warning:
      return "warning";
    case CanBusState::passive:
      return "passive";
    case CanBusState::bus_off:
      return "bus-off";
  }
  return "?";
}

void note_error_frame(const CanFrame& frame, CanBusHealth& health) {
  if (frame.type != CanFrameType::error) return;
  ++health.error_frames;
  if ((frame.id & CAN_ERR_TX_TIMEOUT) != 0) ++health.tx_timeouts;
  if ((frame.id & CAN_ERR_ACK) != 0) ++health.not_acknowledged;
  if ((frame.id & CAN_ERR_PROT) != 0) ++health.protocol_errors;
  if ((frame.id & CAN_ERR_CRTL) != 0) note_controller(frame.bytes[1], health);
  if ((frame.id & kCountersTold) != 0) {
    health.tx_error_counter = frame.bytes[6];
    health.rx_error_counter = frame.bytes[7];
  }
  // A restart clears what the same frame says of a bus that is off.
  if ((frame.id & CAN_ERR_BUSOFF) != 0) {
    ++health.bus_offs;
    health.state = CanBusState::bus_off;
  }
  if ((frame.id & CAN_ERR_RESTARTED) != 0) {
    ++health.restarts;
    health.state = CanBusState::active;
  }
}

}  // namespace pelorus
