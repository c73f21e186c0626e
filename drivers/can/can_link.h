#pragma once
// CanLink: what the kernel knows of a CAN interface: bit rates, format, restart, controller state; asked by rtnetlink
// (linux/if_link.h, linux/can/netlink.h), which needs no privilege. Parsing is pure.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "drivers/can/bus_health.h"

namespace pelorus {

struct CanLink {
  bool exists = false;
  bool is_can = false;  // false: an interface of another kind
  bool up = false;
  bool fd = false;                             // takes FD frames as it is set now
  std::string kind;                            // "can", "vcan", ...; empty = not told
  std::optional<std::uint32_t> bit_rate;       // none: virtual, or not set
  std::optional<std::uint32_t> data_bit_rate;  // of FD payload
  std::optional<std::uint32_t> restart_ms;     // 0: a bus-off controller stays off
  CanBusState state = CanBusState::absent;
};

[[nodiscard]] CanLink read_can_link(const std::string& interface);

// Of one rtnetlink answer (RTM_NEWLINK); anything else is an interface that does not exist.
[[nodiscard]] CanLink parse_can_link(std::span<const std::uint8_t> message);

}  // namespace pelorus
