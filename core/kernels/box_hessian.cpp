#include "core/kernels/box_hessian.h"

#include <array>

#include "core/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/box_hessian.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#ifndef PELORUS_CORE_KERNELS_BOX_HESSIAN_ONCE
#define PELORUS_CORE_KERNELS_BOX_HESSIAN_ONCE
namespace pelorus {
namespace {

constexpr float kMixedWeight = 0.81F;  // 0.9^2: balances the boxes against the Gaussians they stand for (Bay, eq. 3)

// Corners of a rectangle in an integral image, for the first sample of a row.
struct Box {
  const std::uint32_t* top_left;
  const std::uint32_t* top_right;
  const std::uint32_t* bottom_left;
  const std::uint32_t* bottom_right;
};

// The eight rectangles of the three filters.
struct HessianBoxes {
  Box xx_whole, xx_middle, yy_whole, yy_middle;
  Box xy_top_left, xy_top_right, xy_bottom_left, xy_bottom_right;
};

HessianBoxes hessian_boxes(const IntegralImage& integral, int filter_size, int u, int v) {
  const int lobe = filter_size / 3;
  const int reach = hessian_reach(filter_size);
  const int half = (lobe - 1) / 2;
  // Pixels u + u0 .. u + u1, v + v0 .. v + v1, both ends included.
  const auto box = [&](int u0, int u1, int v0, int v1) {
    const std::uint32_t* top = integral.row(v + v0);
    const std::uint32_t* bottom = integral.row(v + v1 + 1);
    const std::ptrdiff_t left = integral.offset(u + u0);
    const std::ptrdiff_t right = integral.offset(u + u1 + 1);
    return Box{top + left, top + right, bottom + left, bottom + right};
  };
  return {box(-reach, reach, 1 - lobe, lobe - 1),
          box(-half, half, 1 - lobe, lobe - 1),
          box(1 - lobe, lobe - 1, -reach, reach),
          box(1 - lobe, lobe - 1, -half, half),
          box(-lobe, -1, -lobe, -1),
          box(1, lobe, -lobe, -1),
          box(-lobe, -1, 1, lobe),
          box(1, lobe, 1, lobe)};
}

}  // namespace
}  // namespace pelorus
#endif  // PELORUS_CORE_KERNELS_BOX_HESSIAN_ONCE

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Sums = hn::RebindToUnsigned<Floats>;
using IntVec = hn::VFromD<Ints>;

// kStride: distance of neighbouring samples in the integral image's phase.
template <int kStride>
HWY_INLINE hn::VFromD<Sums> load(const std::uint32_t* p, std::ptrdiff_t i) {
  const Sums d;
  if constexpr (kStride == 1) {
    return hn::LoadU(d, p + i);
  } else if constexpr (kStride == 2) {
    hn::VFromD<Sums> even, odd;
    hn::LoadInterleaved2(d, p + 2 * i, even, odd);
    return even;
  } else {
    const Ints di;
    const IntVec index = hn::Mul(hn::Iota(di, 0), hn::Set(di, kStride));
    return hn::GatherIndex(d, p + kStride * i, index);
  }
}

template <int kStride>
HWY_INLINE IntVec sum_of(const Box& box, std::ptrdiff_t i) {
  const auto right = hn::Sub(load<kStride>(box.bottom_right, i), load<kStride>(box.top_right, i));
  const auto left = hn::Sub(load<kStride>(box.bottom_left, i), load<kStride>(box.top_left, i));
  return hn::BitCast(Ints(), hn::Sub(right, left));
}

template <int kStride>
HWY_INLINE void responses(const HessianBoxes& boxes, float per_area, std::ptrdiff_t count, float* response) {
  const Floats d;
  const IntVec three = hn::Set(Ints(), 3);
  const auto scale = hn::Set(d, per_area);
  const auto mixed = hn::Set(d, kMixedWeight);
  for (std::ptrdiff_t i = 0; i < count; i += static_cast<std::ptrdiff_t>(hn::Lanes(d))) {
    const IntVec xx = hn::Sub(sum_of<kStride>(boxes.xx_whole, i), hn::Mul(three, sum_of<kStride>(boxes.xx_middle, i)));
    const IntVec yy = hn::Sub(sum_of<kStride>(boxes.yy_whole, i), hn::Mul(three, sum_of<kStride>(boxes.yy_middle, i)));
    const IntVec falling = hn::Add(sum_of<kStride>(boxes.xy_top_left, i), sum_of<kStride>(boxes.xy_bottom_right, i));
    const IntVec rising = hn::Add(sum_of<kStride>(boxes.xy_top_right, i), sum_of<kStride>(boxes.xy_bottom_left, i));
    const auto dxx = hn::Mul(hn::ConvertTo(d, xx), scale);
    const auto dyy = hn::Mul(hn::ConvertTo(d, yy), scale);
    const auto dxy = hn::Mul(hn::ConvertTo(d, hn::Sub(falling, rising)), scale);
    hn::StoreU(hn::Sub(hn::Mul(dxx, dyy), hn::Mul(mixed, hn::Mul(dxy, dxy))), d, response + i);
  }
}

void hessian_row(const HessianBoxes& boxes, float per_area, int stride, int count, float* response) {
  switch (stride) {
    case 1:
      return responses<1>(boxes, per_area, count, response);
    case 2:
      return responses<2>(boxes, per_area, count, response);
    case 4:
      return responses<4>(boxes, per_area, count, response);
    default:
      return responses<8>(boxes, per_area, count, response);
  }
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {
namespace {

std::int32_t sum_of(const Box& box, std::ptrdiff_t i) {
  return static_cast<std::int32_t>((box.bottom_right[i] - box.top_right[i]) - (box.bottom_left[i] - box.top_left[i]));
}

struct Derivatives {
  std::int32_t xx, yy, xy;
};
Derivatives derivatives(const HessianBoxes& boxes, std::ptrdiff_t i) {
  return {sum_of(boxes.xx_whole, i) - 3 * sum_of(boxes.xx_middle, i),
          sum_of(boxes.yy_whole, i) - 3 * sum_of(boxes.yy_middle, i),
          sum_of(boxes.xy_top_left, i) + sum_of(boxes.xy_bottom_right, i) -
              (sum_of(boxes.xy_top_right, i) + sum_of(boxes.xy_bottom_left, i))};
}

float per_area(int filter_size) { return 1.0F / static_cast<float>(filter_size * filter_size); }

}  // namespace

HWY_EXPORT(hessian_row);

void hessian_row(const IntegralImage& integral, int filter_size, int u, int v, int step, int count, float* response) {
  const int stride = step / integral.phases();
  PELORUS_CHECK(stride == 1 || stride == 2 || stride == 4 || stride == 8, "unsupported sampling step");
  HWY_DYNAMIC_DISPATCH(hessian_row)
  (hessian_boxes(integral, filter_size, u, v), per_area(filter_size), stride, count, response);
}

int laplacian_sign(const IntegralImage& integral, int filter_size, int u, int v) {
  const int lobe = filter_size / 3;
  const int reach = hessian_reach(filter_size);
  const int half = (lobe - 1) / 2;
  const std::uint32_t* top = integral.row(v + 1 - lobe);
  const std::uint32_t* bottom = integral.row(v + lobe);
  const auto sum = [&](int u0, int u1) {
    const std::ptrdiff_t left = integral.offset(u + u0);
    const std::ptrdiff_t right = integral.offset(u + u1 + 1);
    return static_cast<std::int32_t>((bottom[right] - top[right]) - (bottom[left] - top[left]));
  };
  return sum(-reach, reach) - 3 * sum(-half, half) >= 0 ? 1 : -1;
}

namespace reference {
void hessian_row(const IntegralImage& integral, int filter_size, int u, int v, int step, int count, float* response) {
  for (int i = 0; i < count; ++i) {
    const Derivatives d = derivatives(hessian_boxes(integral, filter_size, u + i * step, v), 0);
    const float dxx = static_cast<float>(d.xx) * per_area(filter_size);
    const float dyy = static_cast<float>(d.yy) * per_area(filter_size);
    const float dxy = static_cast<float>(d.xy) * per_area(filter_size);
    response[i] = dxx * dyy - kMixedWeight * (dxy * dxy);
  }
}
}  // namespace reference

}  // namespace pelorus
#endif
