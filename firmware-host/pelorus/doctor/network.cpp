#include "firmware-host/pelorus/doctor/network.h"

#include <arpa/inet.h>
#include <sys/socket.h>

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

}  // namespace

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
