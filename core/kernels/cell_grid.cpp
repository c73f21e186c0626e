#include "core/kernels/cell_grid.h"

#include <algorithm>
#include <cstring>

#include "core/base/check.h"
#include "core/kernels/cell_lines.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/cell_grid.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using FloatVec = hn::VFromD<Floats>;

constexpr std::size_t kMaxSpan = 512;     // integral image columns under the grid, in whole vectors of every phase
constexpr std::size_t kPaddedLines = 48;  // lines in whole vectors
using SpanRow = std::array<float, kMaxSpan>;

// Columns of the integral image that the grid's lines need: the same part of every phase.
struct Span {
  std::ptrdiff_t first = 0;         // within a phase
  std::size_t per_phase = 0;        // in whole vectors
  std::ptrdiff_t phase_stride = 0;  // in the integral image
};

// A line of the grid lies at a fraction between two rows of the integral image.
struct LineRows {
  const std::uint32_t* upper;
  const std::uint32_t* lower;
  float fraction;
};

// One vector of a phase: the strip between two lines summed from the span's first column on, as a difference of two
// interpolated rows of the integral image. `part` keeps the fractional row of the line for the next strip.
HWY_INLINE FloatVec strip_vector(const LineRows& above, const LineRows& here, std::ptrdiff_t first, std::ptrdiff_t at,
                                 float* part) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const hn::RebindToUnsigned<Floats> du;
  const auto upper = hn::LoadU(du, here.upper + at);
  const auto rows = hn::Sub(upper, hn::LoadU(du, above.upper + at));
  const auto next = hn::Sub(hn::LoadU(du, here.lower + at), upper);
  // Relative to the first column, or the sums would outgrow a float's 24 bits.
  const auto rows_start = hn::Set(du, here.upper[first] - above.upper[first]);
  const auto next_start = hn::Set(du, here.lower[first] - here.upper[first]);
  const FloatVec whole = hn::ConvertTo(d, hn::BitCast(di, hn::Sub(rows, rows_start)));
  const FloatVec fractional = hn::ConvertTo(d, hn::BitCast(di, hn::Sub(next, next_start)));
  const FloatVec before = hn::Load(d, part);
  const FloatVec now = hn::Mul(hn::Set(d, here.fraction), fractional);
  hn::Store(now, d, part);
  return hn::Add(whole, hn::Sub(now, before));
}

// The whole span, in natural order of columns.
template <int kPhases>
void sum_strip(const Span& span, const LineRows& above, const LineRows& here, float* parts, float* strip) {
  const Floats d;
  const auto lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < span.per_phase; i += lanes) {
    const auto vector = [&](std::ptrdiff_t phase) HWY_ATTR {
      const std::ptrdiff_t at = phase * span.phase_stride + span.first + static_cast<std::ptrdiff_t>(i);
      float* part = parts + static_cast<std::size_t>(phase) * span.per_phase + i;
      return strip_vector(above, here, span.first, at, part);
    };
    if constexpr (kPhases == 1) {
      hn::StoreU(vector(0), d, strip + i);
    } else if constexpr (kPhases == 2) {
      hn::StoreInterleaved2(vector(0), vector(1), d, strip + 2 * i);
    } else {
      hn::StoreInterleaved4(vector(0), vector(1), vector(2), vector(3), d, strip + 4 * i);
    }
  }
}

// The strip's sum up to every line across it: between two neighbouring columns.
void sum_to_lines(const std::array<std::int32_t, kPaddedLines>& place, const std::array<float, kPaddedLines>& fraction,
                  std::size_t lines, const float* strip, float* sums) {
  const Floats d;
  alignas(64) float pairs[2 * kPaddedLines];
  for (std::size_t k = 0; k < lines; ++k) std::memcpy(pairs + 2 * k, strip + place[k], 2 * sizeof(float));
  for (std::size_t k = 0; k < lines; k += hn::Lanes(d)) {
    FloatVec left, right;
    hn::LoadInterleaved2(d, pairs + 2 * k, left, right);
    hn::StoreU(hn::Add(left, hn::Mul(hn::LoadU(d, fraction.data() + k), hn::Sub(right, left))), d, sums + k);
  }
}

template <int kPhases>
bool means(const IntegralImage& integral, const grid::GridLines& columns, const grid::GridLines& rows, int cells,
           CellRows& out) {
  const Floats d;
  const auto count = static_cast<std::size_t>(cells);
  Span span;
  span.phase_stride = integral.stride() / kPhases;
  span.first = columns.entry[0] / kPhases;
  const std::ptrdiff_t last = (columns.entry[count] + 1) / kPhases;
  const std::size_t lanes = hn::Lanes(d);
  span.per_phase = (static_cast<std::size_t>(last - span.first + 1) + lanes - 1) / lanes * lanes;
  if (span.per_phase * kPhases > kMaxSpan) return false;
  std::array<std::int32_t, kPaddedLines> place{};
  std::array<float, kPaddedLines> fraction{};
  for (std::size_t k = 0; k <= count; ++k) {
    place[k] = columns.entry[k] - static_cast<std::int32_t>(span.first) * kPhases;
    fraction[k] = columns.fraction[k];
  }
  alignas(64) SpanRow parts;
  alignas(64) SpanRow strip;
  alignas(64) std::array<float, kPaddedLines + 16> sums{};
  const auto line_at = [&](std::size_t j) {
    const std::uint32_t* upper = integral.row(rows.entry[j]);
    return LineRows{upper, upper + integral.stride(), rows.fraction[j]};
  };
  LineRows above = line_at(0);
  std::fill_n(parts.begin(), span.per_phase * kPhases, 0.0F);
  sum_strip<kPhases>(span, above, above, parts.data(), strip.data());  // only the fractional row of the first line
  for (std::size_t j = 1; j <= count; ++j) {
    const LineRows here = line_at(j);
    sum_strip<kPhases>(span, above, here, parts.data(), strip.data());
    above = here;
    sum_to_lines(place, fraction, count + 1, strip.data(), sums.data());
    float* row = out.data() + (j - 1) * kCellStride;
    const FloatVec per_height = hn::Set(d, rows.per_length[j - 1]);
    for (std::size_t k = 0; k < count; k += lanes) {
      const FloatVec sum = hn::Sub(hn::LoadU(d, sums.data() + k + 1), hn::LoadU(d, sums.data() + k));
      hn::StoreU(hn::Mul(sum, hn::Mul(hn::LoadU(d, columns.per_length.data() + k), per_height)), d, row + k);
    }
  }
  return true;
}

// False when the grid is too large for the scratch.
bool cell_means(const IntegralImage& integral, const grid::GridLines& columns, const grid::GridLines& rows, int cells,
                CellRows& out) {
  switch (integral.phases()) {
    case 1:
      return means<1>(integral, columns, rows, cells, out);
    case 2:
      return means<2>(integral, columns, rows, cells, out);
    default:
      return means<4>(integral, columns, rows, cells, out);
  }
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(cell_means);

namespace reference {

void cell_means(const IntegralImage& integral, float x0, float y0, float size, int cells, CellRows& out) {
  PELORUS_CHECK(size >= 1.0F && cells > 0 && cells <= kMaxCells, "cell grid out of range");
  const grid::GridLines columns = grid::grid_lines(x0, size, cells, integral.width());
  const grid::GridLines rows = grid::grid_lines(y0, size, cells, integral.height());
  if (columns.last_cell < 0 || rows.last_cell < 0) {  // nothing of the grid is in the image
    out.fill(0);
    return;
  }
  // Sums relative to the grid's first corner: small enough for floats.
  const std::uint32_t* origin_row = integral.row(rows.entry[0]);
  const std::ptrdiff_t origin = integral.offset(columns.entry[0]);
  const auto relative = [&](const std::uint32_t* row, std::ptrdiff_t x) {
    return static_cast<float>(static_cast<std::int32_t>((row[x] - row[origin]) - (origin_row[x] - origin_row[origin])));
  };
  std::array<float, grid::kMaxLines> above{};
  for (int j = 0; j <= cells; ++j) {
    const auto line = static_cast<std::size_t>(j);
    const std::uint32_t* upper = integral.row(rows.entry[line]);
    const std::uint32_t* lower = upper + integral.stride();
    std::array<float, grid::kMaxLines> here{};
    for (std::size_t k = 0; k <= static_cast<std::size_t>(cells); ++k) {
      const std::ptrdiff_t left = integral.offset(columns.entry[k]);
      const std::ptrdiff_t right = integral.offset(columns.entry[k] + 1);
      const float l = relative(upper, left) + rows.fraction[line] * (relative(lower, left) - relative(upper, left));
      const float r = relative(upper, right) + rows.fraction[line] * (relative(lower, right) - relative(upper, right));
      here[k] = l + columns.fraction[k] * (r - l);
    }
    if (j > 0) {
      float* row = out.data() + (j - 1) * kCellStride;
      for (std::size_t k = 0; k < static_cast<std::size_t>(cells); ++k) {
        const float sum = (here[k + 1] - here[k]) - (above[k + 1] - above[k]);
        row[k] = sum * (columns.per_length[k] * rows.per_length[line - 1]);
      }
    }
    above = here;
  }
  grid::fill_outside(columns, rows, cells, out);
}

}  // namespace reference

void cell_means(const IntegralImage& integral, float x0, float y0, float size, int cells, CellRows& out) {
  PELORUS_CHECK(size >= 1.0F && cells > 0 && cells <= kMaxCells, "cell grid out of range");
  const grid::GridLines columns = grid::grid_lines(x0, size, cells, integral.width());
  const grid::GridLines rows = grid::grid_lines(y0, size, cells, integral.height());
  if (columns.last_cell < 0 || rows.last_cell < 0) {  // nothing of the grid is in the image
    out.fill(0);
  } else if (HWY_DYNAMIC_DISPATCH(cell_means)(integral, columns, rows, cells, out)) {
    grid::fill_outside(columns, rows, cells, out);
  } else {
    reference::cell_means(integral, x0, y0, size, cells, out);
  }
}

}  // namespace pelorus
#endif
