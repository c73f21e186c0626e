#pragma once
// A network of this process alone: loopback with further addresses. Tests that use fixed ports then disturb nobody,
// and packet sockets work without rights on the machine. Call it before any thread is started.

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <initializer_list>

namespace pelorus::test {

inline bool set_address(int fd, const char* interface, const char* address) {
  ifreq request{};
  std::snprintf(request.ifr_name, sizeof request.ifr_name, "%s", interface);
  sockaddr_in in{};
  in.sin_family = AF_INET;
  if (inet_pton(AF_INET, address, &in.sin_addr) != 1) return false;
  std::memcpy(&request.ifr_addr, &in, sizeof in);
  return ioctl(fd, SIOCSIFADDR, &request) == 0;
}

inline bool set_up(int fd, const char* interface, bool up) {
  ifreq request{};
  std::snprintf(request.ifr_name, sizeof request.ifr_name, "%s", interface);
  if (ioctl(fd, SIOCGIFFLAGS, &request) != 0) return false;
  const int flags = IFF_UP | IFF_RUNNING;
  request.ifr_flags = static_cast<short>(up ? request.ifr_flags | flags : request.ifr_flags & ~flags);
  return ioctl(fd, SIOCSIFFLAGS, &request) == 0;
}

// False when the kernel does not let us; nothing is changed then.
inline bool enter_private_network(std::initializer_list<const char*> more_addresses) {
  if (unshare(geteuid() == 0 ? CLONE_NEWNET : CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  bool good = set_up(fd, "lo", true) && set_address(fd, "lo", "127.0.0.1");
  int alias = 0;
  for (const char* address : more_addresses) {
    char name[IFNAMSIZ];
    std::snprintf(name, sizeof name, "lo:%d", ++alias);
    good = good && set_address(fd, name, address);
  }
  close(fd);
  return good;
}

// A route for multicast over loopback, without which LCM cannot be opened: `change` adds or deletes it.
inline bool change_multicast_route(unsigned long change) {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  rtentry route{};
  const auto set = [](sockaddr& place, std::uint32_t ip) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    in.sin_addr.s_addr = htonl(ip);
    std::memcpy(&place, &in, sizeof in);
  };
  set(route.rt_dst, 0xE0000000);
  set(route.rt_genmask, 0xF0000000);
  set(route.rt_gateway, 0);
  route.rt_flags = RTF_UP;
  char loopback[] = "lo";
  route.rt_dev = loopback;
  const bool changed = ioctl(fd, change, &route) == 0;
  close(fd);
  return changed;
}
inline bool add_multicast_route() { return change_multicast_route(SIOCADDRT); }
inline bool delete_multicast_route() { return change_multicast_route(SIOCDELRT); }

}  // namespace pelorus::test
