#pragma once
// What devices send, turned into the 8-bit gray that everything else works on. Only brightness is kept. Pure.
//
// Deeper pixels lose their lowest bits; of YUV the luma is taken as it is. A Bayer mosaic becomes gray by the kernel
// (1 2 1)^T (1 2 1) / 16, which weighs R, G, B by 1/4, 1/2, 1/4 at every pixel whatever the order of the mosaic: the
// result has full resolution, no colour pattern, and does not depend on where the first red pixel is.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/image.h"

namespace pelorus {

enum class PixelFormat : std::uint8_t {
  unknown,
  gray8,
  gray10,  // in the low bits of 16, little endian, as are the next two
  gray12,
  gray16,
  yuyv,    // Y0 U Y1 V
  uyvy,    // U Y0 V Y1
  nv12,    // plane of Y, then the colour plane, which is not looked at
  bayer8,  // any order
  mjpeg,   // one compressed picture; decoded by JpegFrame
};

[[nodiscard]] std::string_view text(PixelFormat format);

// A picture as it lies in a device's buffer; borrowed.
struct RawPicture {
  const std::uint8_t* bytes = nullptr;
  std::size_t size = 0;  // bytes that the device filled
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // bytes from a row to the next
  PixelFormat format = PixelFormat::unknown;
};

// Bytes that a whole picture needs; 0 for mjpeg and unknown.
[[nodiscard]] std::size_t least_size(const RawPicture& picture);

// Columns u0 to u0 + width - 1 (both even for yuyv, uyvy and bayer8) as gray; `out` keeps its storage when the size
// fits. False: the buffer holds less than a whole picture, or the format is not convertible; `out` is then undefined.
[[nodiscard]] bool to_gray(const RawPicture& picture, int u0, int width, Image& out);

}  // namespace pelorus
