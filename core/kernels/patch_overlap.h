#pragma once
// Which pixels of a patch an image shows: an interval of columns times an interval of rows. Pure.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/kernels/patch.h"

namespace pelorus {

// First and one past the last index.
struct Overlap {
  int begin = 0;
  int end = 0;
};

// Of `size` positions first, first + 1, ... those that lie in [0, extent - 1]; `first` finite and near the image.
inline Overlap overlap(float first, int size, int extent) {
  const int begin = std::clamp(static_cast<int>(std::ceil(-first)), 0, size);
  const int end = std::min(size, static_cast<int>(std::floor(static_cast<float>(extent - 1) - first)) + 1);
  return {begin, std::max(begin, end)};
}

inline Overlap operator&(Overlap a, Overlap b) {
  const int begin = std::max(a.begin, b.begin);
  return {begin, std::max(begin, std::min(a.end, b.end))};
}

// Weight 1 inside, 0 outside.
inline void set_weights(PatchTemplate& patch, Overlap columns, Overlap rows) {
  patch.weight.fill(0);
  for (int r = rows.begin; r < rows.end; ++r) {
    float* row = patch.weight.data() + static_cast<std::ptrdiff_t>(r) * kPatchStride;
    std::fill(row + columns.begin, row + columns.end, 1.0F);
  }
}

}  // namespace pelorus
