#pragma once
// Inner loop of rectification: eight neighbouring output pixels from a window of 3 rows and 16 columns of the input
// image, bilinear in fixed point. Lens distortion is smooth, so that nearly all pixels of a rectified image come in
// such blocks; who builds the blocks takes care of the others. The vector path equals the reference bit by bit. Pure.
// O(blocks), no allocation.

#include <array>
#include <cstdint>
#include <span>

#include "core/base/image.h"

namespace pelorus {

inline constexpr int kRemapBlock = 8;           // output pixels
inline constexpr int kRemapWindowColumns = 16;  // of the input image
inline constexpr int kRemapWindowRows = 3;
inline constexpr int kRemapWeightBits = 7;

struct RemapBlock {
  static constexpr std::uint8_t kBlack = 0x80;  // as column: nothing to see

  std::int16_t out_u = 0;  // first output pixel
  std::int16_t out_v = 0;
  std::int16_t u = 0;  // of the window, which must lie inside the image
  std::int16_t v = 0;
  std::array<std::uint8_t, kRemapBlock> column{};    // of the left input pixel, 0..14, or kBlack
  std::array<std::int8_t, kRemapBlock> lower{};      // -1: the upper input pixels are in the window's second row
  std::array<std::uint8_t, kRemapBlock> weight_u{};  // of the right pixels, 0..128
  std::array<std::uint8_t, kRemapBlock> weight_v{};  // of the lower pixels
};

// `out` is the output image's first pixel, its rows out_stride bytes apart.
void remap(std::span<const RemapBlock> blocks, const ImageView& raw, std::ptrdiff_t out_stride, std::uint8_t* out);

namespace reference {
void remap(std::span<const RemapBlock> blocks, const ImageView& raw, std::ptrdiff_t out_stride, std::uint8_t* out);
}

}  // namespace pelorus
