#include "core/kernels/descriptor_distance.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/descriptor_distance.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void squared_distances(const std::array<float, 64>& query, const DescriptorBlock& block, BlockDistances& out) {
  const hn::CappedTag<float, kBlockDescriptors> d;
  for (std::size_t i = 0; i < kBlockDescriptors; i += hn::Lanes(d)) {
    const float* element = block.element.data() + i;
    // Four sums hide the latency of the additions.
    auto s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
    const auto add = [&](auto sum, std::size_t k) HWY_ATTR {
      const auto difference = hn::Sub(hn::Set(d, query[k]), hn::Load(d, element + k * kBlockDescriptors));
      return hn::Add(sum, hn::Mul(difference, difference));
    };
    for (std::size_t k = 0; k < query.size(); k += 4) {
      s0 = add(s0, k), s1 = add(s1, k + 1), s2 = add(s2, k + 2), s3 = add(s3, k + 3);
    }
    hn::StoreU(hn::Add(hn::Add(s0, s1), hn::Add(s2, s3)), d, out.data() + i);
  }
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(squared_distances);

void squared_distances(const std::array<float, 64>& query, const DescriptorBlock& block, BlockDistances& out) {
  HWY_DYNAMIC_DISPATCH(squared_distances)(query, block, out);
}

namespace reference {
void squared_distances(const std::array<float, 64>& query, const DescriptorBlock& block, BlockDistances& out) {
  for (std::size_t i = 0; i < kBlockDescriptors; ++i) {
    std::array<float, 4> sums{};
    for (std::size_t k = 0; k < query.size(); ++k) {
      const float difference = query[k] - block.element[k * kBlockDescriptors + i];
      sums[k % 4] += difference * difference;
    }
    out[i] = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }
}
}  // namespace reference

}  // namespace pelorus
#endif
