#pragma once
// Determinant of the Hessian by box filters (Bay et al. 2008, section 3.2): Dxx Dyy - (0.9 Dxy)^2, each derivative
// normalised by the filter's area, in squared grey levels. Filter size L = 3 l with odd lobe l: 9, 15, 21, 27, ...
// centred on a pixel. Vector path equals the reference bit by bit. Pure. O(count), no allocation.

#include "core/kernels/integral_image.h"

namespace pelorus {

// Distance from the filter's centre to its last pixel: a response needs that many pixels on every side.
constexpr int hessian_reach(int filter_size) { return (filter_size - 1) / 2; }

// Responses at pixels (u + i * step, v), i = 0..count - 1; step a power of two and multiple of the integral image's
// phases, up to 8 times them. Up to 15 floats past `count` are overwritten.
void hessian_row(const IntegralImage& integral, int filter_size, int u, int v, int step, int count, float* response);

// Of a maximum, where the determinant is positive and Dxx and Dyy have one sign: +1 for it (dark blob on bright
// ground), else -1. Told by Dxx alone.
[[nodiscard]] int laplacian_sign(const IntegralImage& integral, int filter_size, int u, int v);

namespace reference {
void hessian_row(const IntegralImage& integral, int filter_size, int u, int v, int step, int count, float* response);
}

}  // namespace pelorus
