#include "core/kernels/surf_patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>

#include "core/kernels/surf_tables.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/surf_patch.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace surf;

using Floats = hn::CappedTag<float, 16>;
using FloatVec = hn::VFromD<Floats>;
constexpr std::size_t kPadded = 32;  // columns in whole vectors

HWY_INLINE const float* cell_row(const CellRows& cells, int j) {
  return cells.data() + static_cast<std::ptrdiff_t>(j) * kCellStride;
}

// Weighted sums of du, |du|, dv, |dv| over the rows of one window; the four of a column lie together.
void sum_rows(const CellRows& cells, int window_row, float* columns) {
  const Floats d;
  for (std::size_t k = 0; k < kSamples; k += hn::Lanes(d)) {
    FloatVec sum_u = hn::Zero(d), abs_u = sum_u, sum_v = sum_u, abs_v = sum_u;
    const float* row = cell_row(cells, kWindowStep * window_row) + k;
    FloatVec upper_left = hn::LoadU(d, row), upper_right = hn::LoadU(d, row + 1);
    for (int t = 0; t < kWindowSize; ++t) {
      row += kCellStride;
      const FloatVec lower_left = hn::LoadU(d, row), lower_right = hn::LoadU(d, row + 1);
      const FloatVec du = hn::Sub(hn::Add(upper_right, lower_right), hn::Add(upper_left, lower_left));
      const FloatVec dv = hn::Sub(hn::Add(lower_left, lower_right), hn::Add(upper_left, upper_right));
      const FloatVec weight = hn::Set(d, kWithinWindow[static_cast<std::size_t>(t)]);
      sum_u = hn::Add(sum_u, hn::Mul(weight, du));
      abs_u = hn::Add(abs_u, hn::Mul(weight, hn::Abs(du)));
      sum_v = hn::Add(sum_v, hn::Mul(weight, dv));
      abs_v = hn::Add(abs_v, hn::Mul(weight, hn::Abs(dv)));
      upper_left = lower_left, upper_right = lower_right;
    }
    hn::StoreInterleaved4(sum_u, abs_u, sum_v, abs_v, d, columns + 4 * k);
  }
}

void describe_cells(const CellRows& cells, std::array<float, 64>& out) {
  const hn::CappedTag<float, 4> d4;
  alignas(64) float columns[4 * kPadded];
  float* next = out.data();
  for (std::size_t i = 0; i < kWindows; ++i) {
    sum_rows(cells, static_cast<int>(i), columns);
    for (std::size_t j = 0; j < kWindows; ++j, next += 4) {
      const auto across = hn::Set(d4, kAcrossWindows[i] * kAcrossWindows[j]);
      for (std::size_t channel = 0; channel < 4; channel += hn::Lanes(d4)) {
        auto sum = hn::Zero(d4);
        for (std::size_t t = 0; t < kWindowSize; ++t) {
          const auto column = hn::LoadU(d4, columns + 4 * (kWindowStep * j + t) + channel);
          sum = hn::Add(sum, hn::Mul(hn::Set(d4, kWithinWindow[t]), column));
        }
        hn::StoreU(hn::Mul(across, sum), d4, next + channel);
      }
    }
  }
  float square = 0;
  for (const float x : out) square += x * x;
  const float scale = square > 0 ? 1.0F / std::sqrt(square) : 0.0F;
  for (float& x : out) x *= scale;
}

void rotate_cells(const CellRows& cells, float cosine, float sine, CellRows& out) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  constexpr auto kHalf = static_cast<float>(kDescriptorCells / 2);
  const FloatVec c = hn::Set(d, cosine), s = hn::Set(d, sine);
  const FloatVec middle = hn::Set(d, static_cast<float>(kRotatedCells / 2));
  const auto zero = hn::Zero(di);
  const auto last = hn::Set(di, kRotatedCells - 2);
  for (int j = 0; j < kDescriptorCells; ++j) {
    const FloatVec y = hn::Set(d, static_cast<float>(j) - kHalf);
    for (std::size_t k = 0; k < kDescriptorCells; k += hn::Lanes(d)) {
      const FloatVec x = hn::Sub(hn::Iota(d, static_cast<float>(k)), hn::Set(d, kHalf));
      const FloatVec pu = hn::Add(hn::Sub(hn::Mul(c, x), hn::Mul(s, y)), middle);
      const FloatVec pv = hn::Add(hn::Add(hn::Mul(s, x), hn::Mul(c, y)), middle);
      const auto iu = hn::Min(hn::Max(hn::ConvertTo(di, pu), zero), last);
      const auto iv = hn::Min(hn::Max(hn::ConvertTo(di, pv), zero), last);
      const FloatVec fu = hn::Sub(pu, hn::ConvertTo(d, iu));
      const FloatVec fv = hn::Sub(pv, hn::ConvertTo(d, iv));
      alignas(64) std::int32_t place[16];
      alignas(64) float upper[32];
      alignas(64) float lower[32];
      hn::Store(hn::Add(hn::Mul(iv, hn::Set(di, kCellStride)), iu), di, place);
      for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {  // pairs: half the loads of four gathers
        const float* corner = cells.data() + place[lane];
        std::memcpy(upper + 2 * lane, corner, 2 * sizeof(float));
        std::memcpy(lower + 2 * lane, corner + kCellStride, 2 * sizeof(float));
      }
      FloatVec u0, u1, l0, l1;
      hn::LoadInterleaved2(d, upper, u0, u1);
      hn::LoadInterleaved2(d, lower, l0, l1);
      const FloatVec above = hn::Add(u0, hn::Mul(fu, hn::Sub(u1, u0)));
      const FloatVec below = hn::Add(l0, hn::Mul(fu, hn::Sub(l1, l0)));
      hn::StoreU(hn::Add(above, hn::Mul(fv, hn::Sub(below, above))), d, out.data() + j * kCellStride + k);
    }
  }
}

// Bin of each lane's angle; the operations of the reference's turn_of().
HWY_INLINE hn::VFromD<hn::RebindToSigned<Floats>> bins_of(FloatVec u, FloatVec v) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const FloatVec pi = hn::Set(d, std::numbers::pi_v<float>);
  const FloatVec au = hn::Abs(u), av = hn::Abs(v);
  const FloatVec t = hn::Div(hn::Min(au, av), hn::Max(hn::Max(au, av), hn::Set(d, 1e-12F)));
  const FloatVec t2 = hn::Mul(t, t);
  FloatVec angle = hn::Set(d, kArcTangent[0]);
  for (std::size_t i = 1; i < kArcTangent.size(); ++i) {
    angle = hn::Add(hn::Mul(angle, t2), hn::Set(d, kArcTangent[i]));
  }
  angle = hn::Mul(angle, t);
  angle = hn::IfThenElse(hn::Gt(av, au), hn::Sub(hn::Set(d, 0.5F * std::numbers::pi_v<float>), angle), angle);
  angle = hn::IfThenElse(hn::Lt(u, hn::Zero(d)), hn::Sub(pi, angle), angle);
  angle = hn::IfThenElse(hn::Lt(v, hn::Zero(d)), hn::Neg(angle), angle);
  const FloatVec turn = hn::Add(hn::Mul(angle, hn::Set(d, 0.5F / std::numbers::pi_v<float>)), hn::Set(d, 0.5F));
  const auto bin = hn::ConvertTo(di, hn::Mul(turn, hn::Set(d, static_cast<float>(kDirections))));
  return hn::Min(hn::Max(bin, hn::Zero(di)), hn::Set(di, kDirections - 1));
}

// Weighted Haar responses of one row of samples and their bins.
struct ResponseRow {
  alignas(64) float u[16];
  alignas(64) float v[16];
  alignas(64) std::int32_t bin[16];
};

void respond(const CellRows& cells, int j, ResponseRow& out) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  for (std::size_t i = 0; i < kOrientationSamples; i += hn::Lanes(d)) {
    FloatVec left[4], right[4];
    for (int r = 0; r < 4; ++r) {
      const float* c = cell_row(cells, j + r) + i;
      left[r] = hn::Add(hn::LoadU(d, c), hn::LoadU(d, c + 1));
      right[r] = hn::Add(hn::LoadU(d, c + 2), hn::LoadU(d, c + 3));
    }
    const FloatVec u = hn::Sub(hn::Add(hn::Add(right[0], right[1]), hn::Add(right[2], right[3])),
                               hn::Add(hn::Add(left[0], left[1]), hn::Add(left[2], left[3])));
    const FloatVec v = hn::Sub(hn::Add(hn::Add(left[2], right[2]), hn::Add(left[3], right[3])),
                               hn::Add(hn::Add(left[0], right[0]), hn::Add(left[1], right[1])));
    const FloatVec weight = hn::Mul(hn::LoadU(d, kOrientationWeight.data() + i),
                                    hn::Set(d, kOrientationWeight[static_cast<std::size_t>(j)]));
    hn::Store(hn::Mul(weight, u), d, out.u + i);
    hn::Store(hn::Mul(weight, v), d, out.v + i);
    hn::Store(bins_of(u, v), di, out.bin + i);
  }
}

SurfDirection dominant_direction(const CellRows& cells) {
  DirectionBins bins{};
  ResponseRow row;
  for (int j = 0; j < kOrientationSamples; ++j) {
    respond(cells, j, row);
    const auto first = static_cast<std::size_t>(kFirstColumn[static_cast<std::size_t>(j)]);
    for (std::size_t i = first; i < kOrientationSamples - first; ++i) {
      SurfDirection& bin = bins[static_cast<std::size_t>(row.bin[i])];
      bin.u += row.u[i];
      bin.v += row.v[i];
    }
  }
  return strongest_sector(bins);
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(describe_cells);
HWY_EXPORT(rotate_cells);
HWY_EXPORT(dominant_direction);

void describe_cells(const CellRows& cells, std::array<float, 64>& out) {
  HWY_DYNAMIC_DISPATCH(describe_cells)(cells, out);
}

void rotate_cells(const CellRows& cells, float cosine, float sine, CellRows& out) {
  HWY_DYNAMIC_DISPATCH(rotate_cells)(cells, cosine, sine, out);
}

SurfDirection dominant_direction(const CellRows& cells) { return HWY_DYNAMIC_DISPATCH(dominant_direction)(cells); }

namespace {
// The square of `count` cells about a pixel; a pixel covers half a unit to either side of its coordinates.
void cells_about(const IntegralImage& integral, float u, float v, float scale, int count, CellRows& cells) {
  const float reach = 0.5F * static_cast<float>(count) * scale - 0.5F;
  cell_means(integral, u - reach, v - reach, scale, count, cells);
}
}  // namespace

float surf_orientation(const IntegralImage& integral, float u, float v, float scale) {
  CellRows cells;
  cells_about(integral, u, v, scale, kOrientationCells, cells);
  const SurfDirection direction = dominant_direction(cells);
  return std::atan2(direction.v, direction.u);
}

void describe_upright(const IntegralImage& integral, float u, float v, float scale, std::array<float, 64>& out) {
  CellRows cells;
  cells_about(integral, u, v, scale, kDescriptorCells, cells);
  describe_cells(cells, out);
}

void describe_rotated(const IntegralImage& integral, float u, float v, float scale, float angle_rad,
                      std::array<float, 64>& out) {
  CellRows cells;
  CellRows turned;
  cells_about(integral, u, v, scale, kRotatedCells, cells);
  rotate_cells(cells, std::cos(angle_rad), std::sin(angle_rad), turned);
  describe_cells(turned, out);
}

}  // namespace pelorus
#endif
