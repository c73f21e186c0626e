#pragma once
// Each way that pairs can come in has a line: the configured one is tried, of the others it is told what is there.
// Opens files, asks cameras; nothing is set in any of them, so a running service is not disturbed.

#include <optional>
#include <vector>

#include "firmware-host/pelorus/doctor/host_check.h"
#include "firmware-host/pelorus/doctor/storage.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

struct SourceFindings {
  std::vector<HostCheck> checks;
  std::optional<PairFlow> flow;  // of the configured source, when its calibration could be read
};

// `configured`: a configuration was given; without one nothing has to be there.
[[nodiscard]] SourceFindings check_sources(const ServiceConfig& config, bool configured);

// The live cameras' part of it (live_cameras.cpp).
[[nodiscard]] HostCheck check_v4l2(const ServiceConfig& config);
[[nodiscard]] HostCheck check_aravis(const ServiceConfig& config);

// What fits through the network to a camera as a whole; none: no route, or `address` is no IPv4 address.
[[nodiscard]] std::optional<int> path_mtu(const std::string& address);
struct CameraPath {
  std::string address;
  std::optional<int> mtu_bytes;
};
// GigE Vision's packets against the network. `paths`: one for each configured camera whose address is known.
[[nodiscard]] HostCheck judge_packets(const CameraConfig& config, const std::vector<CameraPath>& paths);

}  // namespace pelorus
