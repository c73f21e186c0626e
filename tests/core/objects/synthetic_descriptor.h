#pragma once
// A descriptor of unit length of its own for each place.

#include <cmath>
#include <cstdint>
#include <random>

#include "core/frontend/surf.h"

namespace pelorus::test {

inline SurfDescriptor descriptor_of(std::uint64_t place) {
  std::mt19937_64 random(place);
  std::normal_distribution<float> gauss(0, 1);
  SurfDescriptor d{};
  float sum = 0;
  for (float& x : d) {
    x = gauss(random);
    sum += x * x;
  }
  for (float& x : d) x /= std::sqrt(sum);
  return d;
}

}  // namespace pelorus::test
