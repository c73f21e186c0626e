#pragma once
// Gaussian image pyramid for tracking: level 0 is a copy of the image, each further level is filtered with
// [1 4 6 4 1] / 16 in both directions and sampled at every second pixel (Burt & Adelson 1983; paper 5.1 via KLT).
// Pixel (u, v) of level 0 lies at (u / 2^i, v / 2^i) of level i exactly.
// Each level carries a frame of kBorder replicated pixels on all sides that may be read through its view
// (negative coordinates are legal that far), so that patch reads near the edge need no clamping.
// Storage is reserved by the constructor with a size, or by the first build, and kept while the size stays.
// Thread-bound while building, thread-safe to read. O(pixels); no allocation after the first build of a size.

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"

namespace pelorus {

class ImagePyramid {
 public:
  static constexpr int kMaxLevels = 8;
  static constexpr int kBorder = 16;     // replicated pixels readable around each level
  static constexpr int kMinSizePx = 16;  // no level is smaller than this on its shorter side

  ImagePyramid() = default;
  ImagePyramid(int width, int height, int levels);

  // Fewer levels are built when the image is too small for them; at least one. The view is copied.
  void build(const ImageView& image, int levels);

  [[nodiscard]] int levels() const { return levels_; }
  [[nodiscard]] const ImageView& level(int i) const { return views_[static_cast<std::size_t>(i)]; }

 private:
  void reserve(int width, int height, int levels);

  std::array<Image, kMaxLevels> storage_;  // padded
  std::array<ImageView, kMaxLevels> views_{};
  std::vector<std::uint16_t> column_sums_;
  int levels_ = 0;
};

}  // namespace pelorus
