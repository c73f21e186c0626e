#pragma once
// Lines of a cell grid against an image: shared by the scalar and the vector path of cell_grid.h; not for callers.

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/kernels/cell_grid.h"

namespace pelorus::grid {

inline constexpr std::size_t kMaxLines = kMaxCells + 1;

// Lines of the grid along one axis, clipped to the image, and the cells that have something to show.
struct GridLines {
  std::array<int, kMaxLines> entry{};              // integral image entry at or before the line
  std::array<float, kMaxLines> fraction{};         // of the way to the next entry
  std::array<float, kMaxCells + 16> per_length{};  // 1 / visible length of the cell
  int first_cell = 0;                              // visible cells
  int last_cell = 0;
};

inline GridLines grid_lines(float start, float size, int cells, int extent) {
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
  if (start >= 0 && start + static_cast<float>(cells) * size <= limit) {  // the common case: all of it shows
    lines.per_length.fill(1.0F / size);
    lines.first_cell = 0;
    lines.last_cell = cells - 1;
    return lines;
  }
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
inline void fill_outside(const GridLines& columns, const GridLines& rows, int cells, CellRows& out) {
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

}  // namespace pelorus::grid
