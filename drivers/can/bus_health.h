#pragma once
// What the interface reports about the bus by error frames (linux/can/error.h), kept as a state and counts. A state
// lasts until the controller reports another one. Pure.

#include <cstdint>

#include "drivers/can/can_frame.h"

namespace pelorus {

enum class CanBusState : std::uint8_t {
  absent,   // no such interface, or none usable
  down,     // there, but not up
  active,   // up, and no complaint so far
  warning,  // an error counter of 96 or more
  passive,  // 128 or more: nobody acknowledges, wrong bit rate, cable
  bus_off   // switched off by its own errors; comes back by restart-ms or by hand
};
[[nodiscard]] const char* to_text(CanBusState state);

struct CanBusHealth {
  CanBusState state = CanBusState::absent;
  std::uint64_t error_frames = 0;
  std::uint64_t bus_offs = 0;
  std::uint64_t restarts = 0;
  std::uint64_t not_acknowledged = 0;
  std::uint64_t tx_timeouts = 0;
  std::uint64_t protocol_errors = 0;
  std::uint64_t overruns = 0;  // frames lost in the controller
  std::uint8_t tx_error_counter = 0;
  std::uint8_t rx_error_counter = 0;
};

// Takes one error frame in; other frames change nothing.
void note_error_frame(const CanFrame& frame, CanBusHealth& health);

}  // namespace pelorus
