#pragma once
// The way of LCM's multicast and the room that sockets have. Reads files, asks the kernel's routing with sockets that
// send nothing.

#include <optional>
#include <string>

#include "firmware-host/pelorus/doctor/host_check.h"
#include "firmware-host/pelorus/doctor/host_files.h"
#include "firmware-host/runtime/service_config.h"
#include "services/lcm_address.h"

namespace pelorus {

// Route and reach of the messages.
[[nodiscard]] HostCheck judge_lcm(const LcmConfig& config, const std::optional<LcmAddress>& address,
                                  const MulticastRoute& route);

// Opens the bus and lets LCM hear its own message; needs a route.
[[nodiscard]] HostCheck check_lcm_loopback(const LcmConfig& config, const MulticastRoute& route);

// net.core.rmem_max and rmem_default against what the cameras and LCM need.
[[nodiscard]] HostCheck check_socket_buffers(const HostFiles& files, const ServiceConfig& config, bool raw_network);

}  // namespace pelorus
