#include "firmware-host/pelorus/doctor/network.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <sys/socket.h>

#include <charconv>
#include <cmath>
#include <cstring>
#ifdef PELORUS_WITH_LCM
#include <lcm/lcm-cpp.hpp>
#endif

#include "drivers/unique_fd.h"

namespace pelorus {
namespace {

constexpr long long kGoodDefault = 2097152;  // systemd/60-pelorus.conf; liblcm asks for nothing, so the default counts
constexpr const char* kSysctlCure = "install systemd/60-pelorus.conf as /etc/sysctl.d/60-pelorus.conf; sysctl --system";

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
  if (!url.starts_with(kScheme)) return std::nullopt;
  const std::string rest = url.substr(std::strlen(kScheme));
  const std::size_t question = rest.find('?');
  const std::string place = rest.substr(0, question);
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

HostCheck judge_lcm(const LcmConfig& config, const std::optional<LcmAddress>& address, const MulticastRoute& route) {
  HostCheck check{Verdict::ok, "multicast route", "", ""};
  if (!config.enabled) {
    check.found = "LCM is not used (lcm.enabled: false)";
  } else if (!address) {
    check.verdict = Verdict::fail;
    check.found = "lcm.url '" + config.url + "' is no multicast address";
    check.cure = "lcm.url: \"udpm://239.255.76.67:7667?ttl=0\"";
  } else if (!route.exists) {
    check.verdict = Verdict::fail;
    check.found = "none to " + address->group + " (" + route.problem + "): nobody hears the service";
    check.cure = address->ttl == 0 ? "ip route add 224.0.0.0/4 dev lo (systemd/40-lcm-multicast.network)"
                                   : "ip route add 224.0.0.0/4 dev INTERFACE (systemd/40-lcm-multicast.network)";
  } else {
    check.found = address->group + ":" + std::to_string(address->port) + " by " +
                  (route.interface.empty() ? "an interface without a name" : route.interface) + ", ttl " +
                  std::to_string(address->ttl) + (address->ttl == 0 ? ": heard on this computer only" : "");
    if (address->ttl > 0 && route.interface == "lo") {
      check.verdict = Verdict::warn;
      check.found += ", but loopback reaches no other computer";
      check.cure = "ip route replace 224.0.0.0/4 dev INTERFACE, or ttl=0";
    } else if (address->ttl > 1) {
      check.verdict = Verdict::warn;
      check.found += ": messages leave this network";
      check.cure = "lcm.url: ...?ttl=1 unless a multicast router is meant to pass them on";
    }
  }
  return check;
}

HostCheck check_lcm_loopback(const LcmConfig& config, const MulticastRoute& route) {
  HostCheck check{Verdict::ok, "LCM", "", ""};
  if (!config.enabled || !route.exists) {
    check.found = config.enabled ? "not tried without a multicast route" : "not used";
    return check;
  }
#ifdef PELORUS_WITH_LCM
  lcm::LCM bus(config.url);
  // The first subscription makes LCM send itself a message and wait for it.
  const bool heard = bus.good() && bus.subscribeFunction(
                                       "PELORUS_DOCTOR", +[](const lcm::ReceiveBuffer*, const std::string&, void*) {},
                                       static_cast<void*>(nullptr)) != nullptr;
  check.found =
      heard ? "opens and hears itself; channels " + config.vehicle + ".VIS_*" : "does not hear its own message";
  if (!heard) {
    check.verdict = Verdict::fail;
    check.cure = "a firewall that drops UDP multicast, or an interface without MULTICAST: ip link set lo multicast on";
  }
#else
  check.verdict = Verdict::fail;
  check.found = "not built in";
  check.cure = "build with -DPELORUS_WITH_LCM=ON, or lcm.enabled: false";
#endif
  return check;
}

HostCheck check_socket_buffers(const HostFiles& files, const ServiceConfig& config, bool raw_network) {
  HostCheck check{Verdict::ok, "socket buffers", "", ""};
  const auto largest = files.number("/proc/sys/net/core/rmem_max");
  const auto usual = files.number("/proc/sys/net/core/rmem_default");
  if (!largest) {
    check.verdict = Verdict::warn;
    check.found = "net.core.rmem_max cannot be read";
    check.cure = "look at it as root: sysctl net.core.rmem_max";
    return check;
  }
  check.found = "net.core.rmem_max " + std::to_string(*largest) + ", rmem_default " +
                (usual ? std::to_string(*usual) : std::string("unknown"));
  const bool by_udp = config.source.kind == "aravis" && !(config.camera.packet_socket && raw_network);
  const long long needed = std::llround(config.camera.socket_buffer_mb * 1024 * 1024);
  if (by_udp && *largest < needed) {
    check.verdict = Verdict::fail;
    check.found += ": the cameras by UDP need " + std::to_string(needed) + ", frames will be incomplete";
    check.cure = kSysctlCure;
  } else if (config.lcm.enabled && usual.value_or(0) < kGoodDefault) {
    check.verdict = Verdict::warn;
    check.found += ": bursts of LCM messages may be lost by their listeners";
    check.cure = kSysctlCure;
  }
  return check;
}

}  // namespace pelorus
