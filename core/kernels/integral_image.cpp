#include "core/kernels/integral_image.h"

#include <algorithm>

#include "core/base/check.h"

namespace pelorus {
namespace {

// `above` and `out` are rows of the integral image, column 0 of each already zero.
template <int kShift>
void add_row(const std::uint8_t* pixels, int width, std::ptrdiff_t phase_stride, const std::uint32_t* above,
             std::uint32_t* out) {
  constexpr int kPhases = 1 << kShift;
  std::uint32_t sum = 0;
  int u = 0;
  // Groups of kPhases columns x = u + 1 .. u + kPhases; the last of them begins a new phase cycle.
  for (; u + kPhases <= width; u += kPhases) {
    const std::ptrdiff_t i = u >> kShift;
    for (std::ptrdiff_t phase = 1; phase < kPhases; ++phase) {
      sum += pixels[u + phase - 1];
      out[phase * phase_stride + i] = above[phase * phase_stride + i] + sum;
    }
    sum += pixels[u + kPhases - 1];
    out[i + 1] = above[i + 1] + sum;
  }
  for (; u < width; ++u) {
    const int x = u + 1;
    const std::ptrdiff_t i = (x & (kPhases - 1)) * phase_stride + (x >> kShift);
    sum += pixels[u];
    out[i] = above[i] + sum;
  }
}

}  // namespace

IntegralImage::IntegralImage(int width, int height, int phases)
    : width_(width), height_(height), phase_shift_(phases == 4 ? 2 : phases - 1) {
  PELORUS_CHECK(width > 0 && height > 0, "an integral image needs a size");
  PELORUS_CHECK(phases == 1 || phases == 2 || phases == 4, "integral image phases must be 1, 2 or 4");
  phase_stride_ = width / phases + 1 + kSlack;
  phase_stride_ = (phase_stride_ + 15) / 16 * 16;
  stride_ = phase_stride_ * phases;
  sums_.assign(static_cast<std::size_t>(stride_ * (height + 1)), 0);
}

void IntegralImage::build(const ImageView& image) {
  PELORUS_CHECK(image.width == width_ && image.height == height_, "integral image built from another size");
  for (int v = 0; v < height_; ++v) {
    const std::uint32_t* above = row(v);
    std::uint32_t* out = sums_.data() + (v + 1) * stride_;
    switch (phase_shift_) {
      case 0:
        add_row<0>(image.row(v), width_, phase_stride_, above, out);
        break;
      case 1:
        add_row<1>(image.row(v), width_, phase_stride_, above, out);
        break;
      default:
        add_row<2>(image.row(v), width_, phase_stride_, above, out);
    }
  }
}

}  // namespace pelorus
