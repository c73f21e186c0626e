#pragma once
// One row of the [1 4 6 4 1] x [1 4 6 4 1] / 256 filter with sampling at every second pixel, rounded to nearest.
// Inner loop of ImagePyramid; the vector path equals the reference bit by bit. Pure. O(width), no allocation.

#include <cstddef>
#include <cstdint>

namespace pelorus {

// Elements of scratch that downsample_row needs for an output row of this width.
constexpr std::size_t downsample_scratch_size(int out_width) { return 2 * (static_cast<std::size_t>(out_width) + 80); }

// `center` points at pixel (0, 2 * output row) of the source; 2 rows above and below and 2 pixels left and right
// are read, and up to 128 bytes past the row's end are touched. Up to 63 bytes past `out_width` are overwritten.
void downsample_row(const std::uint8_t* center, std::ptrdiff_t stride, int out_width, std::uint8_t* out,
                    std::uint16_t* scratch);

namespace reference {
void downsample_row(const std::uint8_t* center, std::ptrdiff_t stride, int out_width, std::uint8_t* out);
}

}  // namespace pelorus
