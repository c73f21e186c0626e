#include "firmware-host/runtime/camera_config.h"

#include <cmath>
#include <utility>

#ifdef PELORUS_WITH_ARAVIS
#include "drivers/aravis/aravis_camera.h"
#endif
#ifdef PELORUS_WITH_V4L2
#include "drivers/v4l2/v4l2_camera.h"
#endif

namespace pelorus {
namespace {

using Cameras = std::vector<std::unique_ptr<Camera>>;

#ifdef PELORUS_WITH_ARAVIS
AravisConfig aravis_config(const CameraConfig& c, const std::string& device) {
  AravisConfig a;
  a.device = device;
  if (!c.pixel_format.empty()) a.pixel_format = c.pixel_format;
  a.width_px = c.width_px;
  a.height_px = c.height_px;
  a.rate_hz = c.rate_hz;
  a.exposure_us = c.exposure_ms * 1000;
  a.gain_db = c.gain_db;
  a.trigger = c.trigger;
  a.packet_bytes = c.packet_bytes;
  a.buffers = c.buffers;
  a.packet_socket = c.packet_socket;
  a.socket_buffer_bytes = static_cast<int>(std::lround(c.socket_buffer_mb * 1024 * 1024));
  a.resend = c.resend;
  a.frame_retention_ms = c.frame_retention_ms;
  a.clock = c.clock == "ptp" ? DeviceClockKind::ptp : DeviceClockKind::free_running;
  a.stamp_at = c.stamp_at == "exposure_end"   ? StampAt::exposure_end
               : c.stamp_at == "mid_exposure" ? StampAt::mid_exposure
                                              : StampAt::exposure_start;
  return a;
}
#endif

Cameras make_aravis([[maybe_unused]] const CameraConfig& config, [[maybe_unused]] const CaptureClock& clock) {
  Cameras cameras;
#ifdef PELORUS_WITH_ARAVIS
  for (const std::string& device : {config.left, config.right})
    cameras.push_back(std::make_unique<AravisCamera>(aravis_config(config, device), clock));
#endif
  return cameras;
}

std::vector<CameraProblem> aravis_problems(const CameraConfig& config) {
  if (config.right.empty()) return {{"right", "is not given", "GigE Vision needs two cameras: name both"}};
  return {};
}

#ifdef PELORUS_WITH_V4L2
V4l2Config v4l2_config(const CameraConfig& c, const std::string& device) {
  V4l2Config v;
  v.device = device;
  if (!c.pixel_format.empty()) v.pixel_format = c.pixel_format;
  v.width_px = c.width_px;
  v.height_px = c.height_px;
  v.side_by_side = c.right.empty();
  v.rate_hz = c.rate_hz;
  v.exposure_ms = c.exposure_ms;
  v.readout_ms = c.readout_ms;
  v.buffers = c.buffers;
  return v;
}
#endif

Cameras make_v4l2([[maybe_unused]] const CameraConfig& config, [[maybe_unused]] const CaptureClock& clock) {
  Cameras cameras;
#ifdef PELORUS_WITH_V4L2
  cameras.push_back(std::make_unique<V4l2Camera>(v4l2_config(config, config.left), clock));
  if (!config.right.empty()) cameras.push_back(std::make_unique<V4l2Camera>(v4l2_config(config, config.right), clock));
#endif
  return cameras;
}

std::vector<CameraProblem> v4l2_problems(const CameraConfig& config) {
  const char* cure = "leave it out and set it with v4l2-ctl or a udev rule";
  std::vector<CameraProblem> problems;
  if (!config.trigger.empty()) problems.push_back({"trigger", "cannot be set through V4L2", cure});
  if (config.gain_db >= 0)
    problems.push_back({"gain_db", "cannot be set through V4L2, whose gains have no unit", cure});
  return problems;
}

}  // namespace

StereoSyncConfig sync_config(const CameraConfig& config) {
  return {config.pair_by == "sequence" ? PairBy::sequence : PairBy::time, config.tolerance_ms};
}

std::vector<CameraProblem> camera_problems(const std::string& driver, const CameraConfig& config) {
  if (driver != "aravis" && driver != "v4l2")
    return {{"left", "no driver '" + driver + "' for live cameras", "set source.kind"}};
  std::vector<CameraProblem> problems = driver == "aravis" ? aravis_problems(config) : v4l2_problems(config);
  if (config.left.empty()) {
    problems.insert(problems.begin(), {"left", "is not given", "name the left camera's address or device file"});
  } else if (config.left == config.right) {
    problems.insert(problems.begin(), {"right", "is the left camera again", "name the other one"});
  }
  return problems;
}

std::optional<MissingDriver> missing_driver([[maybe_unused]] const std::string& driver) {
#ifndef PELORUS_WITH_ARAVIS
  if (driver == "aravis") return MissingDriver{"GigE Vision is not built in", "build with -DPELORUS_WITH_ARAVIS=ON"};
#endif
#ifndef PELORUS_WITH_V4L2
  if (driver == "v4l2") return MissingDriver{"V4L2 is not built in", "build with -DPELORUS_WITH_V4L2=ON"};
#endif
  return std::nullopt;
}

Result<Cameras> make_cameras(const std::string& driver, const CameraConfig& config, const CaptureClock& clock) {
  const std::vector<CameraProblem> problems = camera_problems(driver, config);
  if (!problems.empty()) {
    const CameraProblem& first = problems.front();
    return Error{ErrorCode::bad_configuration, "camera." + first.key, first.what, first.cure};
  }
  if (const auto missing = missing_driver(driver))
    return Error{ErrorCode::bad_configuration, "source.kind", missing->what, missing->cure};
  return driver == "aravis" ? make_aravis(config, clock) : make_v4l2(config, clock);
}

}  // namespace pelorus
