#pragma once
// Settings of the service's parts, apart from the parts themselves so that reading a configuration needs none of the
// libraries they use. Units in the names. Pure data.

#include <string>

namespace pelorus {

// When results leave.
struct TimingConfig {
  double latency_ms = 100;           // every result is released this long after mid-exposure
  double deadline_tolerance_ms = 5;  // released later than this after that moment: deadline missed, DEGRADED
};

// When frames stop telling the truth.
struct CaptureWatchConfig {
  double frame_timeout_ms = 0;  // without a pair for so long: CAMERA_FAULT; 0 = 3.5 periods of the pairs
  int frozen_pairs = 3;         // equal pictures in a row before they are a CAMERA_FAULT; 0 = not watched
  double time_jump_ms = 50;     // time stamps that leave the clock by more are a jump
};

// Where the rectified left camera sits in the vehicle: x forward, y starboard, z down.
struct MountingConfig {
  bool given = false;  // false: as the calibration says; if it does not, at the body's origin, looking ahead
  double x_m = 0;
  double y_m = 0;
  double z_m = 0;
  double roll_deg = 0;   // of a camera that looked ahead, turned by yaw, then pitch, then roll
  double pitch_deg = 0;  // -90: looking straight down
  double yaw_deg = 0;
};

// What the program asks of the operating system.
struct ProcessConfig {
  bool realtime = true;     // scheduling class of capture and vision; refused: goes on without
  bool pin = true;          // vision and its helper each on a processor of its own, the last ones
  bool lock_memory = true;  // no page of the program is swapped out; refused: goes on without
};

struct LcmConfig {
  bool enabled = true;
  std::string url = "udpm://239.255.76.67:7667?ttl=0";  // ttl=0: this computer only
  std::string vehicle = "AUV";                          // first part of every channel name
  bool commands = true;                                 // listen on VIS_COMMAND
  double preview_rate_hz = 1;                           // of VIS_IMAGE_LEFT; 0 = none
  int preview_max_bytes = 60000;                        // one datagram, so that no fragment can be lost
};

}  // namespace pelorus
