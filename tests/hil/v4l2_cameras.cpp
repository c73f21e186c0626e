// Recorded pairs as V4L2 cameras of software: two v4l2loopback devices, or one that shows both views side by side, in
// GREY or MJPG. From the first line of standard input on they fire at the multiples of the period on the wall clock and
// show the pair of that moment, forth and back. Who opens them later than that first gets pictures of before.
//
// usage: v4l2_cameras DATASET LEFT_DEVICE RIGHT_DEVICE|- RATE_HZ GREY|MJPG SHOWN_CSV      ends at end of input
// SHOWN_CSV: at the end, every picture that either camera took.

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>

#include "drivers/unique_fd.h"
#include "tests/hil/film.h"

namespace pelorus {
namespace {

constexpr int kJpegQuality = 95;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

using Bytes = std::vector<std::uint8_t>;

// One picture, or two side by side, as the device shall deliver it.
Bytes encoded(const Image& left, const Image* right, bool jpeg) {
  const int width = left.width() + (right != nullptr ? right->width() : 0);
  cv::Mat whole(left.height(), width, CV_8UC1);
  for (int v = 0; v < left.height(); ++v) {
    std::copy_n(left.row(v), left.width(), whole.ptr(v));
    if (right != nullptr) std::copy_n(right->row(v), right->width(), whole.ptr(v) + left.width());
  }
  Bytes bytes(whole.data, whole.data + whole.total());
  if (jpeg) cv::imencode(".jpg", whole, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return bytes;
}

// A v4l2loopback device as its camera sees it.
class Device {
 public:
  // False: said on stderr.
  [[nodiscard]] bool open(const char* path, int width, int height, bool jpeg) {
    fd_ = UniqueFd(::open(path, O_RDWR | O_CLOEXEC));
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    format.fmt.pix.width = static_cast<std::uint32_t>(width);
    format.fmt.pix.height = static_cast<std::uint32_t>(height);
    format.fmt.pix.pixelformat = jpeg ? V4L2_PIX_FMT_MJPEG : V4L2_PIX_FMT_GREY;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    format.fmt.pix.bytesperline = jpeg ? 0 : format.fmt.pix.width;
    format.fmt.pix.sizeimage = format.fmt.pix.width * format.fmt.pix.height;
    // Streaming makes it a capture device for others, before the first picture.
    const bool good =
        fd_ && ::ioctl(fd_.get(), VIDIOC_S_FMT, &format) == 0 && ::ioctl(fd_.get(), VIDIOC_STREAMON, &format.type) == 0;
    if (!good) std::fprintf(stderr, "v4l2_cameras: %s: %s\n", path, std::strerror(errno));
    return good;
  }
  bool show(const Bytes& picture) {
    return ::write(fd_.get(), picture.data(), picture.size()) == static_cast<ssize_t>(picture.size());
  }

 private:
  UniqueFd fd_;
};

struct Cameras {
  std::vector<Device> devices;           // of the left view and of the right one, or of both
  std::vector<std::vector<Bytes>> film;  // of each device
  std::vector<Shown> shown[2];

  void fire(std::int64_t tick, std::int64_t time_ns) {
    const std::size_t frame = Film::index_at(tick, film[0].size());
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (!devices[i].show(film[i][frame])) continue;
      shown[i].push_back({time_ns, frame});
      if (devices.size() == 1) shown[1].push_back({time_ns, frame});
    }
  }
};

Result<Cameras> make_cameras(const Film& film, char** arguments) {
  const bool jpeg = std::strcmp(arguments[5], "MJPG") == 0;
  const bool side_by_side = std::strcmp(arguments[3], "-") == 0;
  const auto& frames = film.frames;
  Cameras cameras;
  for (std::size_t i = 0; i < (side_by_side ? 1 : 2); ++i) {
    const int width = frames[0][0].width() * (side_by_side ? 2 : 1);
    cameras.devices.emplace_back();
    if (!cameras.devices.back().open(arguments[2 + i], width, frames[0][0].height(), jpeg)) {
      return Error{ErrorCode::device, arguments[2 + i], "is no free v4l2loopback device", ""};
    }
    cameras.film.emplace_back();
    for (std::size_t k = 0; k < frames[i].size(); ++k) {
      cameras.film[i].push_back(encoded(frames[i][k], side_by_side ? &frames[1][k] : nullptr, jpeg));
    }
  }
  return cameras;
}

// False: the input has ended before.
bool wait_until(std::int64_t time_ns) {
  for (std::int64_t left = time_ns - now_ns(); left > 0; left = time_ns - now_ns()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const timespec limit{left / 1'000'000'000, left % 1'000'000'000};
    if (::ppoll(&input, 1, &limit, nullptr) > 0) return false;
  }
  return true;
}

int fail(const Error& error) {
  std::fprintf(stderr, "v4l2_cameras: %s\n", error.message().c_str());
  return exit_code(error.code);
}

int run(char** arguments) {
  const Result<Film> film = Film::load(arguments[1]);
  if (!film) return fail(film.error());
  const double rate_hz = std::atof(arguments[4]);
  if (rate_hz <= 0) return 2;
  Result<Cameras> made = make_cameras(film.value(), arguments);
  if (!made) return fail(made.error());
  Cameras& cameras = made.value();
  std::printf("ready: %zu pairs\n", cameras.film[0].size());
  std::fflush(stdout);
  for (int c = ::getchar(); c != '\n' && c != EOF; c = ::getchar()) {
  }
  const double period_ns = 1e9 / rate_hz;
  for (auto tick = static_cast<std::int64_t>(static_cast<double>(now_ns()) / period_ns) + 1;; ++tick) {
    const std::int64_t time_ns = std::llround(static_cast<double>(tick) * period_ns);
    if (!wait_until(time_ns)) break;
    cameras.fire(tick, time_ns);
  }
  if (write_shown(arguments[6], cameras.shown[0], cameras.shown[1])) return 0;
  return fail({ErrorCode::io, arguments[6], "cannot be written", ""});
}

}  // namespace
}  // namespace pelorus

int main(int count, char** arguments) {
  if (count != 7) {
    std::fprintf(stderr, "usage: v4l2_cameras DATASET LEFT_DEVICE RIGHT_DEVICE|- RATE_HZ GREY|MJPG SHOWN_CSV\n");
    return 2;
  }
  return pelorus::run(arguments);
}
