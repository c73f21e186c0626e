#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>

#include "drivers/unique_fd.h"
#include "firmware-host/pelorus/doctor/sources.h"
#ifdef PELORUS_WITH_ARAVIS
#include "drivers/aravis/aravis_discovery.h"
#include "drivers/aravis/gvcp_probe.h"
#endif
#ifdef PELORUS_WITH_V4L2
#include "drivers/v4l2/v4l2_device.h"
#include "drivers/v4l2/v4l2_discovery.h"
#endif

namespace pelorus {
namespace {

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : "; ") + part;
  return text;
}

// What is there, whether it is the source or not.
std::string listed(const std::vector<std::string>& found, const std::string& kind, const ServiceConfig& config) {
  std::string text = found.empty() ? "none found" : "found: " + joined(found);
  if (config.source.kind != kind) text += " (source.kind: " + config.source.kind + ")";
  return text;
}

// The configured devices, or the error that stops all further looking.
std::vector<std::string> configured_devices(const CameraConfig& camera) {
  std::vector<std::string> devices;
  for (const std::string& name : {camera.left, camera.right})
    if (!name.empty()) devices.push_back(name);
  return devices;
}

}  // namespace

HostCheck check_v4l2(const ServiceConfig& config) {
  HostCheck check{Verdict::ok, "source v4l2", "", ""};
  const bool wanted = config.source.kind == "v4l2";
#ifdef PELORUS_WITH_V4L2
  std::vector<std::string> found, good;
  for (const FoundDevice& device : find_v4l2_devices()) {
    found.push_back(device.path + " " + (device.problem.empty() ? device.name : "(" + device.problem + ")"));
  }
  check.found = listed(found, "v4l2", config);
  if (!wanted) return check;
  for (const std::string& path : configured_devices(config.camera)) {
    V4l2Device device;
    const Result<> opened = device.open(path);
    if (!opened)
      return {Verdict::fail, check.topic, opened.error().place + ": " + opened.error().detail + "; " + check.found,
              opened.error().cure};
    good.push_back(path + " (" + device.name() + ")");
  }
  check.found = joined(good) + (good.size() == 1 ? ", both views side by side" : "");
#else
  check.found = "not built in";
  if (wanted) check = {Verdict::fail, check.topic, check.found, "build with -DPELORUS_WITH_V4L2=ON"};
#endif
  return check;
}

HostCheck check_aravis(const ServiceConfig& config) {
  HostCheck check{Verdict::ok, "source aravis", "", ""};
  const bool wanted = config.source.kind == "aravis";
#ifdef PELORUS_WITH_ARAVIS
  const std::vector<FoundCamera> cameras = find_aravis_cameras();
  std::vector<std::string> found, good, missing;
  for (const FoundCamera& c : cameras) found.push_back(c.address + " " + c.vendor + " " + c.model + " " + c.serial);
  check.found = listed(found, "aravis", config);
  if (!wanted) return check;
  for (const std::string& name : configured_devices(config.camera)) {
    const bool discovered = std::any_of(cameras.begin(), cameras.end(), [&](const FoundCamera& c) {
      return name == c.address || name == c.serial || name == c.id;
    });
    const auto address = gvcp_address(name);
    const bool answers = discovered || (address && answers_gvcp(*address));
    (answers ? good : missing).push_back(name);
  }
  if (!missing.empty()) {
    check.verdict = Verdict::fail;
    check.found = joined(missing) + " does not answer; " + check.found;
    check.cure = "power and cable of the camera; an address of this computer in the camera's network (ip addr add ...)";
  } else {
    check.found = joined(good) + " answer";
  }
  if (missing.empty() && good.size() < 2) {
    check = {Verdict::fail, check.topic, "camera.right is not given", "GigE Vision needs two cameras: name both"};
  }
#else
  check.found = "not built in";
  if (wanted) check = {Verdict::fail, check.topic, check.found, "build with -DPELORUS_WITH_ARAVIS=ON"};
#endif
  return check;
}

std::optional<int> path_mtu(const std::string& address) {
#ifdef PELORUS_WITH_ARAVIS
  const auto camera = gvcp_address(address);
  if (!camera) return std::nullopt;
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  // The one cast that the socket interface of C asks for; connecting a datagram socket sends nothing.
  if (!fd || ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&*camera), sizeof *camera) != 0) return std::nullopt;
  int mtu = 0;
  socklen_t size = sizeof mtu;
  if (::getsockopt(fd.get(), IPPROTO_IP, IP_MTU, &mtu, &size) != 0) return std::nullopt;
  return mtu;
#else
  (void)address;
  return std::nullopt;
#endif
}

HostCheck judge_packets(const CameraConfig& config, const std::vector<CameraPath>& paths) {
  constexpr int kPlain = 1500, kJumbo = 9000, kLoopback = 65535;
  HostCheck check{Verdict::ok, "packet size", "camera.packet_bytes " + std::to_string(config.packet_bytes), ""};
  int least = 0;
  for (const CameraPath& path : paths) {
    if (!path.mtu_bytes) {
      check.found += "; the network to " + path.address + " is not known";
      continue;
    }
    check.found += "; to " + path.address + " at most " + std::to_string(*path.mtu_bytes);
    least = least == 0 ? *path.mtu_bytes : std::min(least, *path.mtu_bytes);
  }
  if (least > 0 && config.packet_bytes > least) {
    check.verdict = Verdict::fail;
    check.cure = "ip link set INTERFACE mtu 9000 (and every switch), or camera.packet_bytes: " +
                 std::to_string(least >= kPlain ? 1400 : least - 100);
  } else if (least == 0) {
    check.verdict = Verdict::warn;
    check.cure = "name the cameras by address (camera.left, camera.right)";
  } else if (least >= kJumbo && least < kLoopback && config.packet_bytes <= kPlain) {
    check.found += ": small packets on a network of jumbo frames cost processor time";
    check.verdict = Verdict::warn;
    check.cure = "camera.packet_bytes: 9000 when every switch on the way takes them";
  }
  return check;
}

}  // namespace pelorus
