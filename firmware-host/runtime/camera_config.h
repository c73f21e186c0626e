#pragma once
// Settings of live cameras (section `camera`), whatever the driver, and the cameras made of them. Pure data; the
// factory opens nothing.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "drivers/camera.h"
#include "drivers/capture_clock.h"
#include "drivers/stereo_sync.h"

namespace pelorus {

struct CameraConfig {
  std::string left;          // GigE Vision: IP address, serial number or id; V4L2: device file
  std::string right;         // empty: `left` delivers both views side by side (V4L2)
  std::string pixel_format;  // as the driver names it (Mono8, GREY, ...); empty = 8-bit gray
  int width_px = 0;          // of one view; 0 = as the camera is set
  int height_px = 0;
  double rate_hz = 20;                 // of free-running cameras; 0 = as the camera is set
  double exposure_ms = 0;              // 0 = as the camera is set
  double gain_db = -1;                 // -1 = as the camera is set
  std::string trigger;                 // input line that starts every exposure ("Line1"); empty = free running
  std::string pair_by = "time";        // time: of mid-exposure; sequence: counts of exposures, for triggered cameras
  double tolerance_ms = 2;             // between the mid-exposures of a pair; below half a period
  std::string clock = "free_running";  // ptp: set by PTP to this computer's time (GigE Vision)
  std::string stamp_at = "exposure_start";  // moment that a GigE Vision camera stamps; V4L2 devices tell it
  double readout_ms = 0;        // V4L2: from the end of exposure to the last pixel, for devices that stamp that one
  int packet_bytes = 1400;      // GigE Vision; 9000 where every device on the way takes jumbo frames
  bool packet_socket = true;    // GigE Vision by packet socket, which needs CAP_NET_RAW; else UDP
  double socket_buffer_mb = 4;  // GigE Vision by UDP; the kernel caps it at net.core.rmem_max
  bool resend = true;           // GigE Vision: ask for lost packets again
  int frame_retention_ms = 30;  // GigE Vision: how long a frame waits for its packets
  int buffers = 8;              // between driver and program, each one frame
  int ring_slots = 8;           // frames between capture and vision; at least 8 for two cameras
  double reopen_after_s = 1.5;  // without a frame, at least (reopen_limit()): the camera is closed and opened anew
};

[[nodiscard]] StereoSyncConfig sync_config(const CameraConfig& config);

// What cannot be whatever the devices say and whatever is built in: no device named, a setting that the driver does not
// have.
struct CameraProblem {
  std::string key;  // in section `camera`
  std::string what;
  std::string cure;
};
[[nodiscard]] std::vector<CameraProblem> camera_problems(const std::string& driver, const CameraConfig& config);

// Why this program has no such driver; absent when it has, or there is none of that name. For who opens cameras: a
// file for a vehicle's cameras is good for all else without them.
struct MissingDriver {
  std::string what;
  std::string cure;
};
[[nodiscard]] std::optional<MissingDriver> missing_driver(const std::string& driver);

// One camera of two views or two of one, left first. `driver`: "aravis" or "v4l2".
// Errors: the first of camera_problems, or missing_driver.
[[nodiscard]] Result<std::vector<std::unique_ptr<Camera>>> make_cameras(const std::string& driver,
                                                                        const CameraConfig& config,
                                                                        const CaptureClock& clock);

}  // namespace pelorus
