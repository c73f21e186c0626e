#pragma once
// Settings of a GigE Vision camera. Zero or empty leaves the camera as it is, where that makes sense. Pure data.

#include <string>

#include "drivers/camera_frame.h"
#include "drivers/device_clock.h"

namespace pelorus {

struct AravisConfig {
  // IP address (best: it also chooses the network interface), serial number, or Aravis' id "Vendor-Serial".
  std::string device;
  std::string pixel_format = "Mono8";  // GenICam name
  int width_px = 0;
  int height_px = 0;
  double rate_hz = 0;  // free running only
  double exposure_us = 0;
  double gain_db = -1;      // negative: as it is
  std::string trigger;      // input line that starts each exposure, e.g. "Line1"; empty: free running
  int packet_bytes = 1400;  // of one UDP packet; 9000 where every device on the way takes jumbo frames
  int buffers = 8;          // preallocated frames between network and program
  // Packets by a packet socket (needs CAP_NET_RAW; without it Aravis falls back to UDP by itself).
  bool packet_socket = true;
  int socket_buffer_bytes = 4 << 20;                      // of the UDP socket; the kernel caps it at net.core.rmem_max
  bool resend = true;                                     // ask for lost packets again
  int frame_retention_ms = 30;                            // how long a frame waits for its missing packets
  DeviceClockKind clock = DeviceClockKind::free_running;  // ptp: switched on in the camera where it is offered
  StampAt stamp_at = StampAt::exposure_start;
};

}  // namespace pelorus
