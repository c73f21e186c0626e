#pragma once
// Where LCM's messages go, and whether the kernel has a way there. Asks the kernel's routing with a socket that sends
// nothing. Any thread.

#include <optional>
#include <string>

namespace pelorus {

struct LcmAddress {
  std::string group;
  int port = 0;
  int ttl = 0;  // hops: 0 = this computer, 1 = this network
};
// Of "udpm://group:port?ttl=n", group and port together being optional; none for anything else.
[[nodiscard]] std::optional<LcmAddress> parse_lcm_url(const std::string& url);

struct MulticastRoute {
  bool exists = false;
  std::string interface;  // that packets would leave by; may be empty when unknown
  std::string problem;
};
[[nodiscard]] MulticastRoute find_multicast_route(const LcmAddress& address);

}  // namespace pelorus
