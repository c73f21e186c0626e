#pragma once
// The way of LCM's multicast and the room that sockets have. Reads files, asks the kernel's routing with sockets that
// send nothing.

#include <optional>
#include <string>

#include "firmware-host/pelorus/doctor/host_check.h"
#include "firmware-host/pelorus/doctor/host_files.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

struct LcmAddress {
  std::string group;
  int port = 0;
  int ttl = 0;  // hops: 0 = this computer, 1 = this network
};
// Of "udpm://group:port?ttl=n"; none for anything else.
[[nodiscard]] std::optional<LcmAddress> parse_lcm_url(const std::string& url);

struct MulticastRoute {
  bool exists = false;
  std::string interface;  // that packets would leave by; may be empty when unknown
  std::string problem;
};
[[nodiscard]] MulticastRoute find_multicast_route(const LcmAddress& address);

// Route and reach of the messages.
[[nodiscard]] HostCheck judge_lcm(const LcmConfig& config, const std::optional<LcmAddress>& address,
                                  const MulticastRoute& route);

// Opens the bus and lets LCM hear its own message; needs a route.
[[nodiscard]] HostCheck check_lcm_loopback(const LcmConfig& config, const MulticastRoute& route);

// net.core.rmem_max and rmem_default against what the cameras and LCM need.
[[nodiscard]] HostCheck check_socket_buffers(const HostFiles& files, const ServiceConfig& config, bool raw_network);

}  // namespace pelorus
