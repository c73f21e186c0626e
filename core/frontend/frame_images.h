#pragma once
// The pyramids the front end works on: the current pair, the previous left image, and kept earlier left images
// (references) as long as points are anchored to them. Storage reserved at construction. Thread-bound.

#include <vector>

#include "core/kernels/image_pyramid.h"

namespace pelorus {

struct FrameImages {
  FrameImages(int width, int height, int levels, int references)
      : is_reference(static_cast<std::size_t>(references + 2), false), right(width, height, levels) {
    for (std::size_t slot = 0; slot < is_reference.size(); ++slot) left.emplace_back(width, height, levels);
  }

  std::vector<ImagePyramid> left;  // slots: current, previous and the reference images
  std::vector<bool> is_reference;
  ImagePyramid right;
  int curr = -1;
  int prev = -1;

  [[nodiscard]] const ImagePyramid& current() const { return left[static_cast<std::size_t>(curr)]; }
  [[nodiscard]] const ImagePyramid& previous() const { return left[static_cast<std::size_t>(prev)]; }
};

}  // namespace pelorus
