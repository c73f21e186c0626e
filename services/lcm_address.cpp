#include "services/lcm_address.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <sys/socket.h>

#include <charconv>
#include <cstring>

#include "drivers/unique_fd.h"

namespace pelorus {
namespace {

std::optional<int> whole_number(const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string interface_of(const in_addr& local) {
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return "";
  std::string name;
  for (const ifaddrs* one = all; one != nullptr && name.empty(); one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, one->ifa_addr, sizeof address);
    if (address.sin_addr.s_addr == local.s_addr) name = one->ifa_name;
  }
  ::freeifaddrs(all);
  return name;
}

}  // namespace

std::optional<LcmAddress> parse_lcm_url(const std::string& url) {
  constexpr const char* kScheme = "udpm://";
  constexpr const char* kDefaultPlace = "239.255.76.67:7667";  // LCM's own
  if (!url.empty() && !url.starts_with(kScheme)) return std::nullopt;
  const std::string rest = url.empty() ? "" : url.substr(std::strlen(kScheme));
  const std::size_t question = rest.find('?');
  std::string place = rest.substr(0, question);
  if (place.empty()) place = kDefaultPlace;
  const std::size_t colon = place.find(':');
  if (colon == std::string::npos) return std::nullopt;
  LcmAddress address{place.substr(0, colon), whole_number(place.substr(colon + 1)).value_or(0), 0};
  in_addr group{};
  if (inet_pton(AF_INET, address.group.c_str(), &group) != 1 || !IN_MULTICAST(ntohl(group.s_addr))) return std::nullopt;
  if (address.port < 1 || address.port > 65535) return std::nullopt;
  std::string options = question == std::string::npos ? "" : rest.substr(question + 1);
  while (!options.empty()) {
    const std::size_t end = options.find('&');
    const std::string option = options.substr(0, end);
    if (option.starts_with("ttl=")) {
      const auto ttl = whole_number(option.substr(4));
      if (!ttl || *ttl < 0 || *ttl > 255) return std::nullopt;
      address.ttl = *ttl;
    }
    options = end == std::string::npos ? "" : options.substr(end + 1);
  }
  return address;
}

MulticastRoute find_multicast_route(const LcmAddress& address) {
  MulticastRoute route;
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(static_cast<std::uint16_t>(address.port));
  (void)inet_pton(AF_INET, address.group.c_str(), &group.sin_addr);
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  // The casts that the socket interface of C asks for. Connecting a datagram socket only looks up the route.
  if (!fd || ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0) {
    route.problem = std::strerror(errno);
    return route;
  }
  route.exists = true;
  sockaddr_in local{};
  socklen_t size = sizeof local;
  if (::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&local), &size) == 0) {
    route.interface = interface_of(local.sin_addr);
  }
  return route;
}

}  // namespace pelorus
