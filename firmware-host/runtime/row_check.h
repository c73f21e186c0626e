#pragma once
// measure_rows: how well the rows of a rectified pair agree, seen in the images themselves: patches of the left image
// are searched for in the right one, along and a few rows off their own row. A calibration that no longer fits its
// camera shows here and nowhere else. Rectified pixels. Pure.

#include "core/base/image.h"

namespace pelorus {

struct RowAgreement {
  int patches = 0;       // found again without doubt; under about twenty the figures mean little
  double median_px = 0;  // v in the right image minus v in the left one
  double spread_px = 0;  // half of them lie within this of the median
};

[[nodiscard]] RowAgreement measure_rows(const ImageView& left, const ImageView& right);

}  // namespace pelorus
