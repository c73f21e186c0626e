#pragma once
// Settings of a V4L2 device. Zero or empty leaves the device as it is. Pure data.

#include <string>

namespace pelorus {

struct V4l2Config {
  std::string device;                 // "/dev/video0", better a stable link under /dev/v4l/by-path
  std::string pixel_format = "GREY";  // fourcc: GREY, Y10, Y12, Y16, YUYV, UYVY, NV12, MJPG, BA81, GBRG, GRBG, RGGB
  int width_px = 0;                   // of one view
  int height_px = 0;
  bool side_by_side = false;  // left and right view in one picture of twice the width
  double rate_hz = 0;
  double exposure_ms = 0;  // also switches automatic exposure off
  double readout_ms = 0;   // from the end of exposure to the last pixel, for devices that stamp that one
  int buffers = 4;
  double watchdog_s = 0.75;  // without a frame, at least: see dequeue_limit()
};

}  // namespace pelorus
