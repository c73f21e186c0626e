#include "core/kernels/cell_grid.h"

#include <algorithm>

#include "core/base/check.h"

namespace pelorus {
namespace {

constexpr std::size_t kMaxLines = kMaxCells + 1;

// Lines of the grid along one axis, clipped to the image, and the cells that have something to show.
struct GridLines {
  std::array<int, kMaxLines> entry{};         // integral image entry at or before the line
  std::array<float, kMaxLines> fraction{};    // of the way to the next entry
  std::array<float, kMaxCells> per_length{};  // 1 / visible length of the cell
  int first_cell = 0;                         // visible cells
  int last_cell = 0;
};

GridLines grid_lines(float start, float size, int cells, int extent) {
  GridLines lines;
  std::array<float, kMaxLines> at{};
  const auto limit = static_cast<float>(extent);
  for (int k = 0; k <= cells; ++k) {
    const auto i = static_cast<std::size_t>(k);
    at[i] = std::clamp(start + static_cast<float>(k) * size, 0.0F, limit);
    lines.entry[i] = std::min(static_cast<int>(at[i]), extent - 1);
    lines.fraction[i] = at[i] - static_cast<float>(lines.entry[i]);
  }
  lines.first_cell = cells;
  lines.last_cell = -1;
  for (int k = 0; k < cells; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const float length = at[i + 1] - at[i];
    if (length < 0.25F * size) continue;  // a sliver says little; its neighbour is repeated
    lines.per_length[i] = 1.0F / length;
    lines.first_cell = std::min(lines.first_cell, k);
    lines.last_cell = k;
  }
  return lines;
}

// Rows and columns of cells without content take the nearest that has some.
void fill_outside(const GridLines& columns, const GridLines& rows, int cells, CellRows& out) {
  const auto row_of = [&](int j) { return out.begin() + j * kCellStride; };
  for (int j = rows.first_cell; j <= rows.last_cell; ++j) {
    const auto row = row_of(j);
    std::fill(row, row + columns.first_cell, row[columns.first_cell]);
    std::fill(row + columns.last_cell + 1, row + cells, row[columns.last_cell]);
  }
  for (int j = 0; j < cells; ++j) {
    const int nearest = std::clamp(j, rows.first_cell, rows.last_cell);
    if (nearest != j) std::copy_n(row_of(nearest), cells, row_of(j));
  }
}

}  // namespace

namespace reference {

void cell_means(const IntegralImage& integral, float x0, float y0, float size, int cells, CellRows& out) {
  PELORUS_CHECK(size >= 1.0F && cells > 0 && cells <= kMaxCells, "cell grid out of range");
  const GridLines columns = grid_lines(x0, size, cells, integral.width());
  const GridLines rows = grid_lines(y0, size, cells, integral.height());
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
  std::array<float, kMaxLines> above{};
  for (int j = 0; j <= cells; ++j) {
    const auto line = static_cast<std::size_t>(j);
    const std::uint32_t* upper = integral.row(rows.entry[line]);
    const std::uint32_t* lower = upper + integral.stride();
    std::array<float, kMaxLines> here{};
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
  fill_outside(columns, rows, cells, out);
}

}  // namespace reference

void cell_means(const IntegralImage& integral, float x0, float y0, float size, int cells, CellRows& out) {
  reference::cell_means(integral, x0, y0, size, cells, out);
}

}  // namespace pelorus
