#include "core/kernels/integral_image.h"

#include <algorithm>

#include "core/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/integral_image.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // has no vectors of four
void integral_row(const IntegralRow& row) { reference::integral_row(row); }
#else

constexpr std::size_t kLanes = 4;
using Sums = hn::FixedTag<std::uint32_t, kLanes>;
using SumsV = hn::Vec<Sums>;

// 2^kShift neighbouring pixels in each lane, the first in the lowest byte.
template <int kShift>
HWY_INLINE SumsV load_groups(Sums d, const std::uint8_t* pixels) {
  if constexpr (kShift == 0) {
    return hn::PromoteTo(d, hn::LoadU(hn::FixedTag<std::uint8_t, kLanes>(), pixels));
  } else if constexpr (kShift == 1) {
    const auto pairs = hn::LoadU(hn::FixedTag<std::uint8_t, 2 * kLanes>(), pixels);
    return hn::PromoteTo(d, hn::BitCast(hn::FixedTag<std::uint16_t, kLanes>(), pairs));
  } else {
    return hn::BitCast(d, hn::LoadU(hn::FixedTag<std::uint8_t, 4 * kLanes>(), pixels));
  }
}

// Sum of each lane and those before it.
HWY_INLINE SumsV running_sum(Sums d, SumsV lanes) {
  lanes = hn::Add(lanes, hn::ShiftLeftLanes<1>(d, lanes));
  return hn::Add(lanes, hn::ShiftLeftLanes<2>(d, lanes));
}

template <int kShift>
HWY_INLINE void add_groups(const IntegralRow& row) {
  constexpr int kPhases = 1 << kShift;
  const Sums d;
  const auto groups = static_cast<std::size_t>(row.width >> kShift) / kLanes * kLanes;
  SumsV before = hn::Zero(d);
  for (std::size_t i = 0; i < groups; i += kLanes) {
    const SumsV pixels = load_groups<kShift>(d, row.pixels + (i << kShift));
    SumsV within[kPhases];  // sums over the first 1, 2, ... pixels of each group
    within[0] = hn::And(pixels, hn::Set(d, 0xFF));
    for (int p = 1; p < kPhases; ++p) {
      within[p] = hn::Add(within[p - 1], hn::And(hn::ShiftRightSame(pixels, 8 * p), hn::Set(d, 0xFF)));
    }
    const SumsV whole = within[kPhases - 1];
    const SumsV end = hn::Add(before, running_sum(d, whole));
    const SumsV start = hn::Sub(end, whole);
    for (int p = 1; p < kPhases; ++p) {
      const std::ptrdiff_t at = p * row.phase_stride + static_cast<std::ptrdiff_t>(i);
      hn::StoreU(hn::Add(hn::LoadU(d, row.above + at), hn::Add(start, within[p - 1])), d, row.out + at);
    }
    hn::StoreU(hn::Add(hn::LoadU(d, row.above + i + 1), end), d, row.out + i + 1);
    before = hn::Broadcast<kLanes - 1>(end);
  }
  reference::finish_integral_row(row, static_cast<int>(groups) << kShift, hn::GetLane(before));
}

void integral_row(const IntegralRow& row) {
  switch (row.phase_shift) {
    case 0:
      return add_groups<0>(row);
    case 1:
      return add_groups<1>(row);
    default:
      return add_groups<2>(row);
  }
}
#endif

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(integral_row);

void integral_row(const IntegralRow& row) { HWY_DYNAMIC_DISPATCH(integral_row)(row); }

namespace reference {

void finish_integral_row(const IntegralRow& row, int first, std::uint32_t sum) {
  const int phases = 1 << row.phase_shift;
  for (int x = first + 1; x <= row.width; ++x) {
    const std::ptrdiff_t at = (x & (phases - 1)) * row.phase_stride + (x >> row.phase_shift);
    sum += row.pixels[x - 1];
    row.out[at] = row.above[at] + sum;
  }
}

void integral_row(const IntegralRow& row) { finish_integral_row(row, 0, 0); }

}  // namespace reference

IntegralImage::IntegralImage(int width, int height, int phases)
    : width_(width), height_(height), phase_shift_(phases == 4 ? 2 : phases - 1) {
  PELORUS_CHECK(width > 0 && height > 0, "an integral image needs a size");
  PELORUS_CHECK(phases == 1 || phases == 2 || phases == 4, "integral image phases must be 1, 2 or 4");
  phase_stride_ = width / phases + 1 + kSlack;
  phase_stride_ = (phase_stride_ + 15) / 16 * 16;
  stride_ = phase_stride_ * phases;
  sums_.assign(static_cast<std::size_t>(stride_ * (height + 1)), 0);
}

void IntegralImage::build(const ImageView& image) {
  PELORUS_CHECK(image.width == width_ && image.height == height_, "integral image built from another size");
  for (int v = 0; v < height_; ++v) {
    integral_row({image.row(v), width_, phase_shift_, phase_stride_, row(v), sums_.data() + (v + 1) * stride_});
  }
}

}  // namespace pelorus
#endif
