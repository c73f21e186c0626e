#include "core/kernels/surf_patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/kernels/cell_grid.h"

namespace pelorus {
namespace {

constexpr int kSamples = 24;  // Haar responses per row
constexpr int kRowStride = 32;
constexpr int kWindows = 4;
constexpr int kWindowSize = 9;
constexpr int kWindowStep = 5;

// exp(-t^2 / (2 2.5^2)), t = -4..4: weight of a response within its window.
constexpr std::array<float, kWindowSize> kWithinWindow{0.2780373F, 0.4867523F, 0.7261490F, 0.9231163F, 1.0F,
                                                       0.9231163F, 0.7261490F, 0.4867523F, 0.2780373F};
// exp(-t^2 / (2 1.5^2)), t = -1.5..1.5: weight of a window.
constexpr std::array<float, kWindows> kAcrossWindows{0.6065307F, 0.9459595F, 0.9459595F, 0.6065307F};

using ResponseRows = std::array<float, static_cast<std::size_t>(kSamples* kRowStride)>;

struct HaarResponses {
  ResponseRows du;
  ResponseRows dv;
};

float* response_row(ResponseRows& rows, int j) { return rows.data() + static_cast<std::ptrdiff_t>(j) * kRowStride; }
const float* cell_row(const CellRows& cells, int j) {
  return cells.data() + static_cast<std::ptrdiff_t>(j) * kCellStride;
}

// Weighted sums of du, |du|, dv, |dv| over the rows of one window, per column.
struct WindowColumns {
  std::array<std::array<float, kRowStride>, 4> sum{};
};

void add_rows(HaarResponses& haar, int window_row, WindowColumns& columns) {
  for (int t = 0; t < kWindowSize; ++t) {
    const float weight = kWithinWindow[static_cast<std::size_t>(t)];
    const float* du = response_row(haar.du, kWindowStep * window_row + t);
    const float* dv = response_row(haar.dv, kWindowStep * window_row + t);
    for (std::size_t k = 0; k < kSamples; ++k) {
      columns.sum[0][k] += weight * du[k];
      columns.sum[1][k] += weight * std::abs(du[k]);
      columns.sum[2][k] += weight * dv[k];
      columns.sum[3][k] += weight * std::abs(dv[k]);
    }
  }
}

void form_descriptor(HaarResponses& haar, std::array<float, 64>& out) {
  float* next = out.data();
  float square = 0;
  for (std::size_t i = 0; i < kWindows; ++i) {
    WindowColumns columns;
    add_rows(haar, static_cast<int>(i), columns);
    for (std::size_t j = 0; j < kWindows; ++j) {
      const float across = kAcrossWindows[i] * kAcrossWindows[j];
      for (const auto& row : columns.sum) {
        float sum = 0;
        for (std::size_t t = 0; t < kWindowSize; ++t) sum += kWithinWindow[t] * row[kWindowStep * j + t];
        *next = across * sum;
        square += *next * *next;
        ++next;
      }
    }
  }
  const float scale = square > 0 ? 1.0F / std::sqrt(square) : 0.0F;
  for (float& x : out) x *= scale;
}

// Differences of the 2 x 2 cells around the corner below and right of cell (k, j).
struct Gradient {
  float du, dv;
};
Gradient gradient_at(const float* upper, const float* lower, std::ptrdiff_t k) {
  return {(upper[k + 1] + lower[k + 1]) - (upper[k] + lower[k]), (lower[k] + lower[k + 1]) - (upper[k] + upper[k + 1])};
}

constexpr int kOrientationSamples = 12;  // per axis, at -5.5..5.5 scale
constexpr int kDirections = 60;          // bins of 6 degrees
constexpr int kOpening = 10;             // sliding sector of 60 degrees (Bay, section 4.1)
// exp(-t^2 / (2 2^2)), t = 0.5..5.5
constexpr std::array<float, 6> kOrientationWeight{0.9692332F, 0.7548396F, 0.4578334F,
                                                  0.2162652F, 0.0795595F, 0.0227941F};

float orientation_weight(int i) { return kOrientationWeight[static_cast<std::size_t>(i < 6 ? 5 - i : i - 6)]; }

struct Direction {
  float u = 0, v = 0;
};

// Strongest sum over a sector of kOpening bins.
Direction strongest_sector(const std::array<Direction, kDirections>& bins) {
  Direction best;
  float best_square = -1;
  for (std::size_t start = 0; start < kDirections; ++start) {
    Direction sum;
    for (std::size_t k = 0; k < kOpening; ++k) {
      const Direction& bin = bins[(start + k) % kDirections];
      sum.u += bin.u;
      sum.v += bin.v;
    }
    const float square = sum.u * sum.u + sum.v * sum.v;
    if (square > best_square) best = sum, best_square = square;
  }
  return best;
}

}  // namespace

float surf_orientation(const IntegralImage& integral, float u, float v, float scale) {
  constexpr int kCells = kOrientationSamples + 3;
  CellRows cells;
  cell_means(integral, u + 0.5F - 7.5F * scale, v + 0.5F - 7.5F * scale, scale, kCells, cells);
  std::array<Direction, kDirections> bins{};
  for (int j = 0; j < kOrientationSamples; ++j) {
    for (int i = 0; i < kOrientationSamples; ++i) {
      const int x = 2 * i - 11;  // in half scales
      const int y = 2 * j - 11;
      if (x * x + y * y >= 144) continue;
      Direction d;
      for (int r = 0; r < 4; ++r) {
        const float* row = cell_row(cells, j + r) + i;
        d.u += (row[2] + row[3]) - (row[0] + row[1]);
        d.v += (r < 2 ? -1.0F : 1.0F) * ((row[0] + row[1]) + (row[2] + row[3]));
      }
      const float weight = orientation_weight(i) * orientation_weight(j);
      const float turn = std::atan2(d.v, d.u) * (0.5F / std::numbers::pi_v<float>)+0.5F;  // 0..1
      const int bin = std::clamp(static_cast<int>(turn * kDirections), 0, kDirections - 1);
      bins[static_cast<std::size_t>(bin)].u += weight * d.u;
      bins[static_cast<std::size_t>(bin)].v += weight * d.v;
    }
  }
  const Direction best = strongest_sector(bins);
  return std::atan2(best.v, best.u);
}

void describe_upright(const IntegralImage& integral, float u, float v, float scale, std::array<float, 64>& out) {
  CellRows cells;
  const float reach = 12.5F * scale;
  cell_means(integral, u + 0.5F - reach, v + 0.5F - reach, scale, kSamples + 1, cells);
  HaarResponses haar;
  for (int j = 0; j < kSamples; ++j) {
    const float* upper = cell_row(cells, j);
    const float* lower = cell_row(cells, j + 1);
    float* du = response_row(haar.du, j);
    float* dv = response_row(haar.dv, j);
    for (int k = 0; k < kSamples; ++k) {
      const Gradient g = gradient_at(upper, lower, k);
      du[k] = g.du;
      dv[k] = g.dv;
    }
  }
  form_descriptor(haar, out);
}

void describe_rotated(const IntegralImage& integral, float u, float v, float scale, float angle_rad,
                      std::array<float, 64>& out) {
  constexpr int kCells = 35;  // corners at -16.5..16.5 scale: the rotated grid reaches 11.5 sqrt 2
  constexpr float kFirstCorner = -16.5F;
  CellRows cells;
  const float reach = 17.5F * scale;
  cell_means(integral, u + 0.5F - reach, v + 0.5F - reach, scale, kCells, cells);
  const float c = std::cos(angle_rad);
  const float s = std::sin(angle_rad);
  HaarResponses haar;
  for (int j = 0; j < kSamples; ++j) {
    const float y = static_cast<float>(j) - 11.5F;
    for (int k = 0; k < kSamples; ++k) {
      const float x = static_cast<float>(k) - 11.5F;
      const float pu = (c * x - s * y) - kFirstCorner;
      const float pv = (s * x + c * y) - kFirstCorner;
      const int iu = static_cast<int>(pu);
      const int iv = static_cast<int>(pv);
      const float fu = pu - static_cast<float>(iu);
      const float fv = pv - static_cast<float>(iv);
      const float* rows[3] = {cell_row(cells, iv) + iu, cell_row(cells, iv + 1) + iu, cell_row(cells, iv + 2) + iu};
      const Gradient g00 = gradient_at(rows[0], rows[1], 0);
      const Gradient g01 = gradient_at(rows[0], rows[1], 1);
      const Gradient g10 = gradient_at(rows[1], rows[2], 0);
      const Gradient g11 = gradient_at(rows[1], rows[2], 1);
      const auto mix = [&](float a, float b, float d, float e) {
        const float top = a + fu * (b - a);
        const float bottom = d + fu * (e - d);
        return top + fv * (bottom - top);
      };
      const float gu = mix(g00.du, g01.du, g10.du, g11.du);
      const float gv = mix(g00.dv, g01.dv, g10.dv, g11.dv);
      response_row(haar.du, j)[k] = c * gu + s * gv;
      response_row(haar.dv, j)[k] = c * gv - s * gu;
    }
  }
  form_descriptor(haar, out);
}

}  // namespace pelorus
