#include "drivers/v4l2/v4l2_format.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace pelorus {
namespace {

using namespace std::chrono_literals;

constexpr Duration kFuture = 2ms;  // resolution of stamps and clocks
constexpr Duration kLongAgo = 5s;  // no queue of buffers holds a frame that long

}  // namespace

std::uint32_t fourcc(const std::string& name) {
  if (name.empty() || name.size() > 4) return 0;
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto letter = static_cast<std::uint8_t>(i < name.size() ? name[i] : ' ');
    code |= static_cast<std::uint32_t>(letter) << (8 * i);
  }
  return code;
}

std::string fourcc_name(std::uint32_t code) {
  std::string name;
  for (unsigned i = 0; i < 4; ++i) name += static_cast<char>(code >> (8 * i) & 0x7F);
  return name;
}

PixelFormat pixel_format(std::uint32_t code) {
  switch (code) {
    case V4L2_PIX_FMT_GREY:
      return PixelFormat::gray8;
    case V4L2_PIX_FMT_Y10:
      return PixelFormat::gray10;
    case V4L2_PIX_FMT_Y12:
      return PixelFormat::gray12;
    case V4L2_PIX_FMT_Y16:
      return PixelFormat::gray16;
    case V4L2_PIX_FMT_YUYV:
      return PixelFormat::yuyv;
    case V4L2_PIX_FMT_UYVY:
      return PixelFormat::uyvy;
    case V4L2_PIX_FMT_NV12:
      return PixelFormat::nv12;
    case V4L2_PIX_FMT_SBGGR8:
    case V4L2_PIX_FMT_SGBRG8:
    case V4L2_PIX_FMT_SGRBG8:
    case V4L2_PIX_FMT_SRGGB8:
      return PixelFormat::bayer8;
    case V4L2_PIX_FMT_MJPEG:
    case V4L2_PIX_FMT_JPEG:
      return PixelFormat::mjpeg;
    default:
      return PixelFormat::unknown;
  }
}

Duration dequeue_limit(double least_s, double rate_hz) {
  constexpr double kPeriods = 3;
  const double limit_s = rate_hz > 0 ? std::max(least_s, kPeriods / rate_hz) : least_s;
  return Duration(std::llround(limit_s * 1e9));
}

FrameTime frame_time(const v4l2_buffer& buffer, const ExposureTiming& timing, const CaptureClock& clock,
                     Timestamp arrival) {
  const std::uint32_t stamp_clock = buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK;
  // A copied stamp (v4l2loopback, memory-to-memory devices) is that of whoever fed the device: monotonic by custom.
  const bool readable = stamp_clock == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC || stamp_clock == V4L2_BUF_FLAG_TIMESTAMP_COPY;
  if (!readable) return {arrival, TimeSource::arrival, false};
  const Timestamp stamp = clock.from_monotonic(std::int64_t{buffer.timestamp.tv_sec} * 1'000'000'000 +
                                               std::int64_t{buffer.timestamp.tv_usec} * 1000);
  if (stamp - arrival > kFuture || arrival - stamp > kLongAgo) return {arrival, TimeSource::arrival, true};
  const bool start = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const Timestamp mid = start ? mid_exposure(stamp, StampAt::exposure_start, timing.exposure)
                              : mid_exposure(stamp + -timing.readout, StampAt::exposure_end, timing.exposure);
  return {mid, TimeSource::driver, false};
}

}  // namespace pelorus
