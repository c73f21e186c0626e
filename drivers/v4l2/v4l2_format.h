#pragma once
// The words of V4L2 for pixels and for time, turned into ours. Pure.

#include <linux/videodev2.h>

#include <cstdint>
#include <string>

#include "core/base/time.h"
#include "drivers/camera_frame.h"
#include "drivers/capture_clock.h"
#include "drivers/pixel_format.h"

namespace pelorus {

// Four characters, padded with blanks: "Y10" is "Y10 ". 0 for anything longer or empty.
[[nodiscard]] std::uint32_t fourcc(const std::string& name);
[[nodiscard]] std::string fourcc_name(std::uint32_t code);
// PixelFormat::unknown for pixels we cannot convert.
[[nodiscard]] PixelFormat pixel_format(std::uint32_t fourcc);

struct ExposureTiming {
  Duration exposure{};  // 0 = unknown
  Duration readout{};   // from the end of exposure to the last pixel
};

struct FrameTime {
  Timestamp mid_exposure;
  TimeSource source = TimeSource::arrival;
  bool corrected = false;  // the stamp lay in the future or long ago: the arrival was taken
};

// How long a stream may be silent before it is restarted: `least_s`, but three periods of a slow camera, which is not
// silent because its next picture is not due yet. `rate_hz` 0 = unknown.
[[nodiscard]] Duration dequeue_limit(double least_s, double rate_hz);

// Mid-exposure of a dequeued buffer from its stamp, its clock (V4L2_BUF_FLAG_TIMESTAMP_*) and the moment that was
// stamped (V4L2_BUF_FLAG_TSTAMP_SRC_*: start of exposure, or end of frame = last pixel received).
[[nodiscard]] FrameTime frame_time(const v4l2_buffer& buffer, const ExposureTiming& timing, const CaptureClock& clock,
                                   Timestamp arrival);

}  // namespace pelorus
