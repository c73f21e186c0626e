#pragma once
// Squared distance of two 64-float descriptors. The vector path equals the reference bit by bit: 16 column sums,
// added in halves. Pure. No allocation.

#include <array>

namespace pelorus {

[[nodiscard]] float squared_distance(const std::array<float, 64>& a, const std::array<float, 64>& b);

namespace reference {
[[nodiscard]] float squared_distance(const std::array<float, 64>& a, const std::array<float, 64>& b);
}

}  // namespace pelorus
