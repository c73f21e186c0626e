// Scalar twins of surf_patch.cpp: the same operations in the same order, for tests and for reading.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/kernels/surf_tables.h"

namespace pelorus::reference {
namespace {

using namespace surf;

const float* cell_row(const CellRows& cells, int j) {
  return cells.data() + static_cast<std::ptrdiff_t>(j) * kCellStride;
}

// Difference of the 2 x 2 cells around the corner below and right of cell k.
struct Gradient {
  float du, dv;
};
Gradient gradient_at(const float* upper, const float* lower, int k) {
  return {(upper[k + 1] + lower[k + 1]) - (upper[k] + lower[k]), (lower[k] + lower[k + 1]) - (upper[k] + upper[k + 1])};
}

// Weighted sums of du, |du|, dv, |dv| over the rows of one window, per column.
using WindowColumns = std::array<std::array<float, 4>, kSamples>;

WindowColumns sum_rows(const CellRows& cells, int window_row) {
  WindowColumns columns{};
  for (int t = 0; t < kWindowSize; ++t) {
    const float weight = kWithinWindow[static_cast<std::size_t>(t)];
    const float* upper = cell_row(cells, kWindowStep * window_row + t);
    const float* lower = cell_row(cells, kWindowStep * window_row + t + 1);
    for (int k = 0; k < kSamples; ++k) {
      const Gradient g = gradient_at(upper, lower, k);
      auto& sum = columns[static_cast<std::size_t>(k)];
      sum[0] += weight * g.du;
      sum[1] += weight * std::abs(g.du);
      sum[2] += weight * g.dv;
      sum[3] += weight * std::abs(g.dv);
    }
  }
  return columns;
}

// Angle from -pi to pi as 0..1.
float turn_of(SurfDirection d) {
  const float au = std::abs(d.u);
  const float av = std::abs(d.v);
  const float t = std::min(au, av) / std::max(std::max(au, av), 1e-12F);
  const float t2 = t * t;
  float angle = kArcTangent[0];
  for (std::size_t i = 1; i < kArcTangent.size(); ++i) angle = angle * t2 + kArcTangent[i];
  angle = angle * t;
  if (av > au) angle = 0.5F * std::numbers::pi_v<float> - angle;
  if (d.u < 0) angle = std::numbers::pi_v<float> - angle;
  if (d.v < 0) angle = -angle;
  return angle * (0.5F / std::numbers::pi_v<float>)+0.5F;
}

}  // namespace

void describe_cells(const CellRows& cells, std::array<float, 64>& out) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < kWindows; ++i) {
    const WindowColumns columns = sum_rows(cells, static_cast<int>(i));
    for (std::size_t j = 0; j < kWindows; ++j) {
      const float across = kAcrossWindows[i] * kAcrossWindows[j];
      for (std::size_t channel = 0; channel < 4; ++channel) {
        float sum = 0;
        for (std::size_t t = 0; t < kWindowSize; ++t) sum += kWithinWindow[t] * columns[kWindowStep * j + t][channel];
        out[next++] = across * sum;
      }
    }
  }
  float square = 0;
  for (const float x : out) square += x * x;
  const float scale = square > 0 ? 1.0F / std::sqrt(square) : 0.0F;
  for (float& x : out) x *= scale;
}

void rotate_cells(const CellRows& cells, float cosine, float sine, CellRows& out) {
  constexpr auto kMiddle = static_cast<float>(kRotatedCells / 2);
  constexpr auto kHalf = static_cast<float>(kDescriptorCells / 2);
  for (int j = 0; j < kDescriptorCells; ++j) {
    const float y = static_cast<float>(j) - kHalf;
    for (int k = 0; k < kDescriptorCells; ++k) {
      const float x = static_cast<float>(k) - kHalf;
      const float pu = (cosine * x - sine * y) + kMiddle;
      const float pv = (sine * x + cosine * y) + kMiddle;
      const int iu = std::clamp(static_cast<int>(pu), 0, kRotatedCells - 2);
      const int iv = std::clamp(static_cast<int>(pv), 0, kRotatedCells - 2);
      const float fu = pu - static_cast<float>(iu);
      const float fv = pv - static_cast<float>(iv);
      const float* upper = cell_row(cells, iv) + iu;
      const float* lower = cell_row(cells, iv + 1) + iu;
      const float above = upper[0] + fu * (upper[1] - upper[0]);
      const float below = lower[0] + fu * (lower[1] - lower[0]);
      out[static_cast<std::size_t>(j * kCellStride + k)] = above + fv * (below - above);
    }
  }
}

SurfDirection dominant_direction(const CellRows& cells) {
  DirectionBins bins{};
  for (int j = 0; j < kOrientationSamples; ++j) {
    const auto row = static_cast<std::size_t>(j);
    for (int i = kFirstColumn[row]; i < kOrientationSamples - kFirstColumn[row]; ++i) {
      float left[4];
      float right[4];
      for (int r = 0; r < 4; ++r) {
        const float* c = cell_row(cells, j + r) + i;
        left[r] = c[0] + c[1];
        right[r] = c[2] + c[3];
      }
      SurfDirection d;
      d.u = ((right[0] + right[1]) + (right[2] + right[3])) - ((left[0] + left[1]) + (left[2] + left[3]));
      d.v = ((left[2] + right[2]) + (left[3] + right[3])) - ((left[0] + right[0]) + (left[1] + right[1]));
      const float weight = kOrientationWeight[static_cast<std::size_t>(i)] * kOrientationWeight[row];
      const int bin = std::clamp(static_cast<int>(turn_of(d) * kDirections), 0, kDirections - 1);
      bins[static_cast<std::size_t>(bin)].u += weight * d.u;
      bins[static_cast<std::size_t>(bin)].v += weight * d.v;
    }
  }
  return strongest_sector(bins);
}

}  // namespace pelorus::reference
