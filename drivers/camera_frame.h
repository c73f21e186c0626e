#pragma once
// CameraFrame: what a camera delivers, in storage that is used again and again. Raw pixels (as the calibration
// describes them), 8-bit gray. A device that sees with both eyes at once (side by side, recorded pairs, the synthetic
// world) fills two views of the same exposure, any other device one. Pure.

#include <array>
#include <cstdint>

#include "core/base/image.h"
#include "core/base/time.h"

namespace pelorus {

enum class TimeSource : std::uint8_t {
  hardware,  // the device's own clock, mapped to the capture clock (PTP, chunk data, recorded stamps)
  driver,    // stamped by the kernel or the transport when the frame started or ended
  arrival,   // no better stamp: when the program received it
};

// Which moment of the exposure a device stamps.
enum class StampAt : std::uint8_t { exposure_start, mid_exposure, exposure_end };

[[nodiscard]] constexpr Timestamp mid_exposure(Timestamp stamp, StampAt at, Duration exposure) {
  if (at == StampAt::exposure_start) return stamp + exposure / 2;
  if (at == StampAt::exposure_end) return stamp + -exposure / 2;
  return stamp;
}

struct FrameFormat {
  int width = 0;
  int height = 0;
  int views = 1;  // 2: left and right of the same exposure
};

struct CameraFrame {
  std::uint64_t seq = 0;   // the device's count of exposures, unwrapped; a gap is frames lost before the program
  Timestamp mid_exposure;  // capture clock
  Timestamp arrival;       // capture clock, when the program had the whole frame
  Duration exposure{};     // 0 = unknown, mid_exposure is then the best known stamp
  TimeSource time_source = TimeSource::arrival;
  int views = 1;
  std::array<Image, 2> view;  // [0] the camera's, or the left one; [1] the right one when views == 2

  void resize(const FrameFormat& format) {
    views = format.views;
    for (int i = 0; i < views; ++i) view[static_cast<std::size_t>(i)].resize(format.width, format.height);
  }
};

}  // namespace pelorus
