#include "core/kernels/remap.h"

#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/remap.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // has no byte shuffles
void remap(std::span<const RemapBlock> blocks, const ImageView& raw, std::ptrdiff_t out_stride, std::uint8_t* out) {
  reference::remap(blocks, raw, out_stride, out);
}
#else

using Shorts = hn::CappedTag<std::int16_t, kRemapBlock>;
using ShortVec = hn::VFromD<Shorts>;
using Bytes = hn::Repartition<std::uint8_t, Shorts>;
using Words = hn::RepartitionToWide<Shorts>;

// Both pixels of a row for eight columns.
struct Neighbours {
  ShortVec left, right;
};

HWY_INLINE Neighbours pick(const std::uint8_t* row, ShortVec left, ShortVec right) {
  const Shorts d;
  const Bytes d8;
  const auto window = hn::LoadU(d8, row);
  return {hn::BitCast(d, hn::TableLookupBytesOr0(window, hn::BitCast(d8, left))),
          hn::BitCast(d, hn::TableLookupBytesOr0(window, hn::BitCast(d8, right)))};
}

// At most 255 * 128.
HWY_INLINE ShortVec blend(const Neighbours& p, ShortVec weight) {
  return hn::Add(hn::ShiftLeft<kRemapWeightBits>(p.left), hn::Mul(hn::Sub(p.right, p.left), weight));
}

void remap_block(const RemapBlock& block, const ImageView& raw, std::uint8_t* out) {
  const Shorts d;
  const Words d32;
  const hn::Rebind<std::uint8_t, Shorts> d8;
  const hn::Rebind<std::int8_t, Shorts> di8;
  // The high byte of each index points nowhere and reads as zero.
  const ShortVec left = hn::Or(hn::PromoteTo(d, hn::LoadU(d8, block.column.data())),
                               hn::BitCast(d, hn::Set(hn::RebindToUnsigned<Shorts>(), std::uint16_t{0x8000})));
  const ShortVec right = hn::Add(left, hn::Set(d, std::int16_t{1}));
  const std::uint8_t* first = raw.row(block.v) + block.u;
  const Neighbours row0 = pick(first, left, right);
  const Neighbours row1 = pick(first + raw.stride, left, right);
  const Neighbours row2 = pick(first + 2 * raw.stride, left, right);
  const auto lower = hn::MaskFromVec(hn::PromoteTo(d, hn::LoadU(di8, block.lower.data())));
  const ShortVec weight_u = hn::PromoteTo(d, hn::LoadU(d8, block.weight_u.data()));
  const ShortVec weight_v = hn::PromoteTo(d, hn::LoadU(d8, block.weight_v.data()));
  const ShortVec top =
      blend({hn::IfThenElse(lower, row1.left, row0.left), hn::IfThenElse(lower, row1.right, row0.right)}, weight_u);
  const ShortVec bottom =
      blend({hn::IfThenElse(lower, row2.left, row1.left), hn::IfThenElse(lower, row2.right, row1.right)}, weight_u);
  const ShortVec weight_top = hn::Sub(hn::Set(d, std::int16_t{1 << kRemapWeightBits}), weight_v);
  const auto sum = [&](ShortVec pixels, ShortVec weights) HWY_ATTR {  // pairs of (top, bottom)
    auto odd = hn::Zero(d32);
    const auto even = hn::ReorderWidenMulAccumulate(d32, pixels, weights, hn::Zero(d32), odd);
    const auto rounding = hn::Set(d32, 1 << (2 * kRemapWeightBits - 1));
    return hn::ShiftRight<2 * kRemapWeightBits>(hn::Add(hn::RearrangeToOddPlusEven(even, odd), rounding));
  };
  const auto first_half = sum(hn::InterleaveLower(d, top, bottom), hn::InterleaveLower(d, weight_top, weight_v));
  const auto second_half = sum(hn::InterleaveUpper(d, top, bottom), hn::InterleaveUpper(d, weight_top, weight_v));
  const hn::Half<Shorts> half;
  const ShortVec all = hn::Combine(d, hn::DemoteTo(half, second_half), hn::DemoteTo(half, first_half));
  hn::StoreU(hn::DemoteTo(d8, all), d8, out);
}

void remap(std::span<const RemapBlock> blocks, const ImageView& raw, std::ptrdiff_t out_stride, std::uint8_t* out) {
  for (const RemapBlock& block : blocks) remap_block(block, raw, out + block.out_v * out_stride + block.out_u);
}
#endif  // HWY_SCALAR

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(remap);

void remap(std::span<const RemapBlock> blocks, const ImageView& raw, std::ptrdiff_t out_stride, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(remap)(blocks, raw, out_stride, out);
}

namespace reference {

void remap(std::span<const RemapBlock> blocks, const ImageView& raw, std::ptrdiff_t out_stride, std::uint8_t* out) {
  constexpr int kOne = 1 << kRemapWeightBits;
  for (const RemapBlock& block : blocks) {
    std::uint8_t* place = out + block.out_v * out_stride + block.out_u;
    for (std::size_t i = 0; i < kRemapBlock; ++i) {
      if (block.column[i] >= RemapBlock::kBlack) {
        place[i] = 0;
        continue;
      }
      const std::uint8_t* upper = raw.row(block.v - block.lower[i]) + block.u + block.column[i];
      const std::uint8_t* lower = upper + raw.stride;
      const int top = upper[0] * (kOne - block.weight_u[i]) + upper[1] * block.weight_u[i];
      const int bottom = lower[0] * (kOne - block.weight_u[i]) + lower[1] * block.weight_u[i];
      const int sum = top * (kOne - block.weight_v[i]) + bottom * block.weight_v[i];
      place[i] = static_cast<std::uint8_t>((sum + kOne * kOne / 2) >> (2 * kRemapWeightBits));
    }
  }
}

}  // namespace reference
}  // namespace pelorus
#endif
