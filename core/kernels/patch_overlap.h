#pragma once
// Which pixels of a patch an image shows: an interval of columns times an interval of rows. Pure.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "core/kernels/patch.h"

namespace pelorus {

// First and one past the last index.
struct Overlap {
  int begin = 0;
  int end = 0;
};

// Of `size` positions first, first + 1, ... those that lie in [0, extent - 1]; `first` finite and near the image.
inline Overlap overlap(float first, int size, int extent) {
  if (first >= 0 && first + static_cast<float>(size - 1) <= static_cast<float>(extent - 1)) return {0, size};
  const int begin = std::clamp(static_cast<int>(std::ceil(-first)), 0, size);
  const int end = std::min(size, static_cast<int>(std::floor(static_cast<float>(extent - 1) - first)) + 1);
  return {begin, std::max(begin, end)};
}

inline Overlap operator&(Overlap a, Overlap b) {
  const int begin = std::max(a.begin, b.begin);
  return {begin, std::max(begin, std::min(a.end, b.end))};
}

// In use inside, masked outside.
inline void set_mask(PatchTemplate& patch, Overlap columns, Overlap rows) {
  std::array<std::int16_t, kPatchStride> row{};
  std::fill(row.begin() + columns.begin, row.begin() + columns.end, std::int16_t{-1});
  std::int16_t* out = patch.mask.data();
  for (int r = 0; r < patch.size; ++r, out += kPatchStride) {
    if (r >= rows.begin && r < rows.end) {
      std::memcpy(out, row.data(), sizeof(row));
    } else {
      std::memset(out, 0, sizeof(row));
    }
  }
}

}  // namespace pelorus
