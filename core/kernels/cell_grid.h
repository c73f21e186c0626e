#pragma once
// Means of the image over a square grid of square cells of any real size and place: the scale-normalised patch that
// SURF descriptors are made of. Corners of cells fall between pixels; the integral image is interpolated there, which
// integrates the piecewise constant image exactly, so that the patch moves and grows smoothly with the point instead
// of in whole pixels. Cells outside the image repeat the nearest cell inside. Pure. O(cells), no allocation.

#include <array>

#include "core/kernels/integral_image.h"

namespace pelorus {

inline constexpr int kMaxCells = 40;
inline constexpr int kCellStride = 48;  // floats per row: kMaxCells and room for vector stores
using CellRows = std::array<float, static_cast<std::size_t>(kMaxCells* kCellStride)>;

// Cell (i, j) covers [x0 + i * size, x0 + (i + 1) * size) x [y0 + j * size, ...) in coordinates of the integral image
// (pixel u covers [u, u + 1)); out[j * kCellStride + i] receives its mean. size >= 1, cells <= kMaxCells.
void cell_means(const IntegralImage& integral, float x0, float y0, float size, int cells, CellRows& out);

namespace reference {
void cell_means(const IntegralImage& integral, float x0, float y0, float size, int cells, CellRows& out);
}

}  // namespace pelorus
