#pragma once
#include <cstdint>
#include <random>

#include "core/base/image.h"

namespace pelorus::test {

inline Image random_image(int width, int height, unsigned seed) {
  std::mt19937 rng(seed);
  Image image(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) image.row(v)[u] = static_cast<std::uint8_t>(rng());
  }
  return image;
}

}  // namespace pelorus::test
