#include "core/kernels/downsample.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/downsample.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kLead = 8;  // room for element -1

template <class D, class V>
V binomial_sum(D d, V a, V b, V c, V e, V f) {
  const V inner = hn::ShiftLeft<2>(hn::Add(b, e));
  const V middle = hn::Mul(c, hn::Set(d, 6));
  return hn::Add(hn::Add(a, f), hn::Add(inner, middle));
}

void downsample_row(const std::uint8_t* center, std::ptrdiff_t stride, int out_width, std::uint8_t* out,
                    std::uint16_t* scratch) {
  const hn::ScalableTag<std::uint16_t> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const hn::RebindToSigned<decltype(d16)> di16;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d16));
  const std::ptrdiff_t width = out_width;
  std::uint16_t* even = scratch + kLead;
  std::uint16_t* odd = scratch + downsample_scratch_size(out_width) / 2 + kLead;

  // Down the columns, even and odd columns apart: even[i] is column 2 i, odd[i] column 2 i + 1. At most 4080.
  for (std::ptrdiff_t i = -1; i <= width; i += lanes) {
    const std::uint8_t* p = center + 2 * i;
    hn::VFromD<decltype(d8)> e[5];
    hn::VFromD<decltype(d8)> o[5];
    for (std::ptrdiff_t r = 0; r < 5; ++r) hn::LoadInterleaved2(d8, p + (r - 2) * stride, e[r], o[r]);
    const auto wide = [&](auto v) { return hn::PromoteTo(d16, v); };
    hn::StoreU(binomial_sum(d16, wide(e[0]), wide(e[1]), wide(e[2]), wide(e[3]), wide(e[4])), d16, even + i);
    hn::StoreU(binomial_sum(d16, wide(o[0]), wide(o[1]), wide(o[2]), wide(o[3]), wide(o[4])), d16, odd + i);
  }
  // Along the row: at most 65280 + 128, which still fits 16 bits.
  const auto half = hn::Set(d16, 128);
  for (std::ptrdiff_t i = 0; i < width; i += lanes) {
    const auto sum = binomial_sum(d16, hn::LoadU(d16, even + i - 1), hn::LoadU(d16, odd + i - 1),
                                  hn::LoadU(d16, even + i), hn::LoadU(d16, odd + i), hn::LoadU(d16, even + i + 1));
    const auto rounded = hn::ShiftRight<8>(hn::Add(sum, half));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(di16, rounded)), d8, out + i);
  }
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(downsample_row);

void downsample_row(const std::uint8_t* center, std::ptrdiff_t stride, int out_width, std::uint8_t* out,
                    std::uint16_t* scratch) {
  HWY_DYNAMIC_DISPATCH(downsample_row)(center, stride, out_width, out, scratch);
}

namespace reference {
void downsample_row(const std::uint8_t* center, std::ptrdiff_t stride, int out_width, std::uint8_t* out) {
  constexpr int kTaps[5] = {1, 4, 6, 4, 1};
  for (int i = 0; i < out_width; ++i) {
    int sum = 128;
    for (int r = 0; r < 5; ++r) {
      const std::uint8_t* row = center + (r - 2) * stride + 2 * i - 2;
      for (int c = 0; c < 5; ++c) sum += kTaps[r] * kTaps[c] * row[c];
    }
    out[i] = static_cast<std::uint8_t>(sum >> 8);
  }
}
}  // namespace reference

}  // namespace pelorus
#endif
