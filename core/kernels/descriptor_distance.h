#pragma once
// Squared distances of 64-float descriptors, sixteen at a time: candidates are stored transposed in blocks, so that
// one vector holds the same element of sixteen descriptors and no sum crosses lanes. Elements are added in order: every
// vector path equals the reference bit by bit. Pure. No allocation.

#include <array>
#include <cstddef>

namespace pelorus {

inline constexpr std::size_t kBlockDescriptors = 16;

// element[k * 16 + i] is element k of descriptor i.
struct DescriptorBlock {
  alignas(64) std::array<float, 64 * kBlockDescriptors> element{};

  void set(std::size_t i, const std::array<float, 64>& descriptor) {
    for (std::size_t k = 0; k < descriptor.size(); ++k) element[k * kBlockDescriptors + i] = descriptor[k];
  }
};

using BlockDistances = std::array<float, kBlockDescriptors>;

void squared_distances(const std::array<float, 64>& query, const DescriptorBlock& block, BlockDistances& out);

namespace reference {
void squared_distances(const std::array<float, 64>& query, const DescriptorBlock& block, BlockDistances& out);
}

}  // namespace pelorus
