#pragma once
// V4l2Device: one video capture device and its states: closed -> opened -> configured -> streaming. Buffers are mapped
// kernel memory; a dequeued one is borrowed until give_back(). Thread-bound. Errors name the device, the request that
// failed and the cure.

#include <linux/videodev2.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/time.h"
#include "drivers/pixel_format.h"
#include "drivers/unique_fd.h"
#include "drivers/v4l2/v4l2_config.h"

namespace pelorus {

// What the device agreed to, which is what counts.
struct V4l2Format {
  std::uint32_t fourcc = 0;
  PixelFormat pixels = PixelFormat::unknown;
  int width = 0;  // of the whole picture
  int height = 0;
  std::ptrdiff_t stride = 0;
  double rate_hz = 0;      // 0 = unknown
  double exposure_ms = 0;  // 0 = unknown
};

class V4l2Device {
 public:
  enum class Dequeued : std::uint8_t { buffer, nothing, broken, gone };

  V4l2Device() = default;
  ~V4l2Device() { close(); }
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  [[nodiscard]] Result<> open(const std::string& path);
  [[nodiscard]] Result<> configure(const V4l2Config& config);
  [[nodiscard]] Result<> start(int buffers);
  // Waits at most `timeout`. buffer: `buffer` is filled and its bytes() readable until give_back().
  // broken: an error that may pass; gone: the device cannot be used any more.
  [[nodiscard]] Dequeued dequeue(v4l2_buffer& buffer, Duration timeout);
  [[nodiscard]] RawPicture picture(const v4l2_buffer& buffer) const;
  // False: the device is gone.
  [[nodiscard]] bool give_back(v4l2_buffer& buffer);
  // Back to configured.
  void stop();
  void close();

  [[nodiscard]] bool streaming() const { return state_ == State::streaming; }
  [[nodiscard]] const V4l2Format& format() const { return format_; }
  [[nodiscard]] const std::string& name() const { return name_; }  // driver and card

 private:
  struct Mapping {
    void* start = nullptr;
    std::size_t size = 0;
  };
  enum class State : std::uint8_t { closed, opened, configured, streaming };

  [[nodiscard]] Error problem(const std::string& what, const std::string& cure) const;
  [[nodiscard]] Error failed(const char* request, const std::string& cure) const;
  [[nodiscard]] Result<> set_format(const V4l2Config& config);
  [[nodiscard]] Result<> map_buffers(int wanted);
  void set_rate(double rate_hz);
  void set_exposure(double exposure_ms);
  void unmap_buffers();
  [[nodiscard]] int request(unsigned long code, void* argument) const;

  UniqueFd fd_;
  State state_ = State::closed;
  std::string path_;
  std::string name_;
  V4l2Format format_;
  std::vector<Mapping> mappings_;
};

}  // namespace pelorus
