#include "drivers/pixel_format.h"

#include <cstring>

namespace pelorus {
namespace {

int bytes_per_pixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::gray8:
    case PixelFormat::nv12:
    case PixelFormat::bayer8:
      return 1;
    case PixelFormat::gray10:
    case PixelFormat::gray12:
    case PixelFormat::gray16:
    case PixelFormat::yuyv:
    case PixelFormat::uyvy:
      return 2;
    case PixelFormat::mjpeg:
    case PixelFormat::unknown:
      break;
  }
  return 0;
}

// One byte of every two, from the first (offset 0) or the second.
void every_second(const std::uint8_t* in, int count, std::uint8_t* out) {
  for (int u = 0; u < count; ++u) out[u] = in[2 * u];
}

void shifted(const std::uint8_t* in, int count, int shift, std::uint8_t* out) {
  for (int u = 0; u < count; ++u) {
    const unsigned value = in[2 * u] | static_cast<unsigned>(in[2 * u + 1]) << 8;
    const unsigned reduced = value >> shift;
    out[u] = static_cast<std::uint8_t>(reduced > 255 ? 255 : reduced);  // bits above the depth must not wrap
  }
}

// Rows and columns beyond the border are mirrored without repeating the border, which keeps the mosaic's order.
int mirrored(int i, int count) {
  if (i < 0) return -i;
  return i < count ? i : 2 * count - 2 - i;
}

void bayer_row(const RawPicture& p, int u0, int width, int v, std::uint8_t* out) {
  const std::uint8_t* above = p.bytes + mirrored(v - 1, p.height) * p.stride;
  const std::uint8_t* here = p.bytes + v * p.stride;
  const std::uint8_t* below = p.bytes + mirrored(v + 1, p.height) * p.stride;
  const auto column = [&](int u) { return above[u] + 2 * here[u] + below[u]; };
  for (int u = u0; u < u0 + width; ++u) {
    const int sum = column(mirrored(u - 1, p.width)) + 2 * column(u) + column(mirrored(u + 1, p.width));
    out[u - u0] = static_cast<std::uint8_t>((sum + 8) / 16);
  }
}

void convert_row(const RawPicture& p, int u0, int width, int v, std::uint8_t* out) {
  const std::uint8_t* in = p.bytes + v * p.stride + static_cast<std::ptrdiff_t>(u0) * bytes_per_pixel(p.format);
  switch (p.format) {
    case PixelFormat::gray8:
    case PixelFormat::nv12:
      std::memcpy(out, in, static_cast<std::size_t>(width));
      return;
    case PixelFormat::gray10:
      return shifted(in, width, 2, out);
    case PixelFormat::gray12:
      return shifted(in, width, 4, out);
    case PixelFormat::gray16:
      return every_second(in + 1, width, out);
    case PixelFormat::yuyv:
      return every_second(in, width, out);
    case PixelFormat::uyvy:
      return every_second(in + 1, width, out);
    case PixelFormat::bayer8:
      return bayer_row(p, u0, width, v, out);
    case PixelFormat::mjpeg:
    case PixelFormat::unknown:
      return;
  }
}

}  // namespace

std::string_view text(PixelFormat format) {
  switch (format) {
    case PixelFormat::unknown:
      return "unknown";
    case PixelFormat::gray8:
      return "gray 8";
    case PixelFormat::gray10:
      return "gray 10";
    case PixelFormat::gray12:
      return "gray 12";
    case PixelFormat::gray16:
      return "gray 16";
    case PixelFormat::yuyv:
      return "YUYV";
    case PixelFormat::uyvy:
      return "UYVY";
    case PixelFormat::nv12:
      return "NV12";
    case PixelFormat::bayer8:
      return "Bayer 8";
    case PixelFormat::mjpeg:
      return "Motion JPEG";
  }
  return "unknown";
}

std::size_t least_size(const RawPicture& p) {
  const int pixel = bytes_per_pixel(p.format);
  if (pixel == 0 || p.width <= 0 || p.height <= 0) return 0;
  return static_cast<std::size_t>(p.stride) * static_cast<std::size_t>(p.height - 1) +
         static_cast<std::size_t>(p.width * pixel);
}

bool to_gray(const RawPicture& picture, int u0, int width, Image& out) {
  const std::size_t needed = least_size(picture);
  if (needed == 0 || picture.bytes == nullptr || picture.size < needed) return false;
  if (u0 < 0 || width <= 0 || u0 + width > picture.width) return false;
  // The kernel needs neighbours on both sides to mirror.
  if (picture.format == PixelFormat::bayer8 && (picture.width < 2 || picture.height < 2)) return false;
  out.resize(width, picture.height);
  for (int v = 0; v < picture.height; ++v) convert_row(picture, u0, width, v, out.row(v));
  return true;
}

}  // namespace pelorus
