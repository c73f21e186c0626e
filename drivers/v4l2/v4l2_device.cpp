#include "drivers/v4l2/v4l2_device.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "drivers/v4l2/v4l2_format.h"

namespace pelorus {
namespace {

constexpr auto kType = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr double kExposureUnitMs = 0.1;  // of V4L2_CID_EXPOSURE_ABSOLUTE

}  // namespace

int V4l2Device::request(unsigned long code, void* argument) const {
  int answer = 0;
  do {
    answer = ::ioctl(fd_.get(), code, argument);
  } while (answer < 0 && errno == EINTR);
  return answer;
}

Error V4l2Device::problem(const std::string& what, const std::string& cure) const {
  return {ErrorCode::device, path_, what, cure};
}

Error V4l2Device::failed(const char* what, const std::string& cure) const {
  return problem(std::string(what) + ": " + std::strerror(errno), cure);
}

Result<> V4l2Device::open(const std::string& path) {
  close();
  path_ = path;
  fd_ = UniqueFd(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (!fd_) {
    return failed("cannot be opened", errno == EACCES ? "add the service's user to the group video"
                                                      : "check the cable; `v4l2-ctl --list-devices` lists devices");
  }
  v4l2_capability capability{};
  if (request(VIDIOC_QUERYCAP, &capability) < 0) {
    fd_.reset();
    return problem("is no V4L2 device", "name a /dev/video* or /dev/v4l/by-path/* device");
  }
  const bool per_node = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t caps = per_node ? capability.device_caps : capability.capabilities;
  if ((caps & V4L2_CAP_VIDEO_CAPTURE) == 0 || (caps & V4L2_CAP_STREAMING) == 0) {
    fd_.reset();
    return problem("does not capture by streaming single-plane pictures",
                   "a camera often has several devices; name the one that captures");
  }
  name_ = std::string(reinterpret_cast<const char*>(capability.driver)) + " " +
          reinterpret_cast<const char*>(capability.card);
  state_ = State::opened;
  return Ok{};
}

Result<> V4l2Device::configure(const V4l2Config& config) {
  PELORUS_CHECK(state_ == State::opened || state_ == State::configured, "configure() of a closed or streaming device");
  if (Result<> set = set_format(config); !set) return set;
  set_rate(config.rate_hz);
  set_exposure(config.exposure_ms);
  state_ = State::configured;
  return Ok{};
}

Result<> V4l2Device::set_format(const V4l2Config& config) {
  v4l2_format format{};
  format.type = kType;
  if (request(VIDIOC_G_FMT, &format) < 0) return failed("does not tell its format", "");
  v4l2_pix_format& pix = format.fmt.pix;
  const auto width = static_cast<std::uint32_t>(config.side_by_side ? 2 * config.width_px : config.width_px);
  const auto height = static_cast<std::uint32_t>(config.height_px);
  if (width > 0) pix.width = width;
  if (height > 0) pix.height = height;
  const std::uint32_t wanted = config.pixel_format.empty() ? pix.pixelformat : fourcc(config.pixel_format);
  pix.pixelformat = wanted;
  pix.field = V4L2_FIELD_NONE;
  pix.bytesperline = 0;  // the driver's choice
  if (request(VIDIOC_S_FMT, &format) < 0) {
    return failed("refuses its format", errno == EBUSY ? "another program uses the device" : "");
  }
  const std::string size = std::to_string(pix.width) + "x" + std::to_string(pix.height);
  if ((width > 0 && pix.width != width) || (height > 0 && pix.height != height)) {
    return problem("offers " + size + " instead of " + std::to_string(width) + "x" + std::to_string(height),
                   "`v4l2-ctl -d " + path_ + " --list-formats-ext` lists what it offers");
  }
  format_ = {pix.pixelformat,
             pixel_format(pix.pixelformat),
             static_cast<int>(pix.width),
             static_cast<int>(pix.height),
             static_cast<std::ptrdiff_t>(pix.bytesperline),
             0,
             0};
  if (pix.pixelformat != wanted || format_.pixels == PixelFormat::unknown) {
    return problem("offers pixels " + fourcc_name(pix.pixelformat) + " instead of " + config.pixel_format,
                   "use GREY, Y10, Y12, Y16, YUYV, UYVY, NV12, MJPG or an 8-bit Bayer format that it offers");
  }
  if (format_.stride == 0) {  // left open by some drivers: rows without padding
    const bool one_byte = format_.pixels == PixelFormat::gray8 || format_.pixels == PixelFormat::nv12 ||
                          format_.pixels == PixelFormat::bayer8;
    format_.stride = static_cast<std::ptrdiff_t>(format_.width) * (one_byte ? 1 : 2);
  }
  return Ok{};
}

// A device without a settable rate keeps its own; description and statistics show what it is.
void V4l2Device::set_rate(double rate_hz) {
  v4l2_streamparm parameters{};
  parameters.type = kType;
  if (rate_hz > 0) {
    parameters.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(1000 * rate_hz))};
    static_cast<void>(request(VIDIOC_S_PARM, &parameters));
  }
  parameters = {};
  parameters.type = kType;
  const v4l2_fract& period = parameters.parm.capture.timeperframe;
  if (request(VIDIOC_G_PARM, &parameters) == 0 && period.numerator > 0) {
    format_.rate_hz = static_cast<double>(period.denominator) / static_cast<double>(period.numerator);
  }
}

void V4l2Device::set_exposure(double exposure_ms) {
  if (exposure_ms > 0) {
    v4l2_control manual{V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL};
    static_cast<void>(request(VIDIOC_S_CTRL, &manual));
    v4l2_control time{V4L2_CID_EXPOSURE_ABSOLUTE,
                      static_cast<std::int32_t>(std::lround(exposure_ms / kExposureUnitMs))};
    static_cast<void>(request(VIDIOC_S_CTRL, &time));
  }
  v4l2_control time{V4L2_CID_EXPOSURE_ABSOLUTE, 0};
  if (request(VIDIOC_G_CTRL, &time) == 0) format_.exposure_ms = time.value * kExposureUnitMs;
}

Result<> V4l2Device::start(int buffers) {
  PELORUS_CHECK(state_ == State::configured, "start() needs a configured device");
  if (Result<> mapped = map_buffers(buffers); !mapped) {
    unmap_buffers();
    return mapped;
  }
  for (std::uint32_t i = 0; i < mappings_.size(); ++i) {
    v4l2_buffer buffer{};
    buffer.type = kType;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = i;
    if (!give_back(buffer)) {
      unmap_buffers();
      return failed("does not take its buffers", "");
    }
  }
  int type = kType;
  if (request(VIDIOC_STREAMON, &type) < 0) {
    const Error error = failed("does not start", "two cameras on one USB bus may exceed its bandwidth");
    unmap_buffers();
    return error;
  }
  state_ = State::streaming;
  return Ok{};
}

Result<> V4l2Device::map_buffers(int wanted) {
  v4l2_requestbuffers asked{};
  asked.count = static_cast<std::uint32_t>(wanted);
  asked.type = kType;
  asked.memory = V4L2_MEMORY_MMAP;
  if (request(VIDIOC_REQBUFS, &asked) < 0) return failed("gives no buffers", "another program may use the device");
  if (asked.count < 2) return problem("gives fewer than two buffers", "");
  for (std::uint32_t i = 0; i < asked.count; ++i) {
    v4l2_buffer buffer{};
    buffer.type = kType;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = i;
    if (request(VIDIOC_QUERYBUF, &buffer) < 0) return failed("does not describe its buffers", "");
    void* start = ::mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, fd_.get(), buffer.m.offset);
    if (start == MAP_FAILED) return failed("cannot map its buffers", "");
    mappings_.push_back({start, buffer.length});
  }
  return Ok{};
}

V4l2Device::Dequeued V4l2Device::dequeue(v4l2_buffer& buffer, Duration timeout) {
  PELORUS_CHECK(state_ == State::streaming, "dequeue() needs a streaming device");
  pollfd readable{fd_.get(), POLLIN, 0};
  const auto limit_ms = std::chrono::ceil<std::chrono::milliseconds>(std::max(timeout, Duration::zero())).count();
  const int ready = ::poll(&readable, 1, static_cast<int>(limit_ms));
  if (ready == 0 || (ready < 0 && errno == EINTR)) return Dequeued::nothing;
  if (ready < 0 || (readable.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return Dequeued::gone;
  buffer = {};
  buffer.type = kType;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (request(VIDIOC_DQBUF, &buffer) == 0) return buffer.index < mappings_.size() ? Dequeued::buffer : Dequeued::gone;
  if (errno == EAGAIN) return Dequeued::nothing;
  return errno == EIO ? Dequeued::broken : Dequeued::gone;  // EIO: "temporary problems like signal loss"
}

RawPicture V4l2Device::picture(const v4l2_buffer& buffer) const {
  const Mapping& mapping = mappings_[buffer.index];
  // Some drivers leave bytesused at 0 for pictures of fixed size.
  const std::size_t used = buffer.bytesused > 0 ? std::min<std::size_t>(buffer.bytesused, mapping.size) : mapping.size;
  return {static_cast<const std::uint8_t*>(mapping.start),
          used,
          format_.width,
          format_.height,
          format_.stride,
          format_.pixels};
}

bool V4l2Device::give_back(v4l2_buffer& buffer) { return request(VIDIOC_QBUF, &buffer) == 0; }

void V4l2Device::stop() {
  if (state_ != State::streaming) return;
  int type = kType;
  static_cast<void>(request(VIDIOC_STREAMOFF, &type));  // fails only for a device that is gone
  unmap_buffers();
  state_ = State::configured;
}

void V4l2Device::unmap_buffers() {
  for (const Mapping& mapping : mappings_) ::munmap(mapping.start, mapping.size);
  mappings_.clear();
  v4l2_requestbuffers none{};
  none.type = kType;
  none.memory = V4L2_MEMORY_MMAP;
  static_cast<void>(request(VIDIOC_REQBUFS, &none));
}

void V4l2Device::close() {
  stop();
  fd_.reset();
  state_ = State::closed;
}

}  // namespace pelorus
