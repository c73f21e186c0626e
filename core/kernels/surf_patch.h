#pragma once
// Orientation and descriptor of a SURF point (Bay et al. 2008, section 4), from cell means of side `scale` around it.
// Haar responses are differences of neighbouring cells: wavelets of side 2 scale on a 24 x 24 grid of spacing scale;
// 4 x 4 windows of 9 x 9 responses overlap by 4 and are weighted by Gaussians as in M-SURF (Agrawal et al. 2008).
// Per window: sum dx, sum |dx|, sum dy, sum |dy|; windows row by row; unit length (all zero on a flat patch).
// Image coordinates in px (integers at pixel centres), scale >= 1. Pure. O(1), no allocation, ~20 kB of stack.

#include <array>

#include "core/kernels/cell_grid.h"
#include "core/kernels/integral_image.h"

namespace pelorus {

// Dominant direction of Haar responses of side 4 scale within 6 scale, from u towards v, rad.
[[nodiscard]] float surf_orientation(const IntegralImage& integral, float u, float v, float scale);

void describe_upright(const IntegralImage& integral, float u, float v, float scale, std::array<float, 64>& out);
void describe_rotated(const IntegralImage& integral, float u, float v, float scale, float angle_rad,
                      std::array<float, 64>& out);

// The parts above that are inner loops, from cells (see cell_grid.h); vector paths equal the reference bit by bit.
inline constexpr int kDescriptorCells = 25;   // per side
inline constexpr int kRotatedCells = 35;      // per side: what 25 cells need at any angle
inline constexpr int kOrientationCells = 15;  // per side

// Descriptor of kDescriptorCells^2 cells.
void describe_cells(const CellRows& cells, std::array<float, 64>& out);
// kDescriptorCells^2 cells turned by (cosine, sine) about the middle of kRotatedCells^2 cells, bilinearly.
void rotate_cells(const CellRows& cells, float cosine, float sine, CellRows& out);

struct SurfDirection {
  float u = 0;
  float v = 0;
};
// Strongest sum of Haar responses over a sector of 60 degrees (section 4.1), from kOrientationCells^2 cells.
[[nodiscard]] SurfDirection dominant_direction(const CellRows& cells);

namespace reference {
void describe_cells(const CellRows& cells, std::array<float, 64>& out);
void rotate_cells(const CellRows& cells, float cosine, float sine, CellRows& out);
[[nodiscard]] SurfDirection dominant_direction(const CellRows& cells);
}  // namespace reference

}  // namespace pelorus
