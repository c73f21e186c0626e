#include "core/kernels/image_pyramid.h"

#include <algorithm>
#include <cstring>

#include "core/base/check.h"
#include "core/kernels/downsample.h"

namespace pelorus {
namespace {

// Columns left of the image; wider than kBorder so that rows start at half a cache line. The right side has as
// many plus the slack into which downsample_row may write past the row's end.
constexpr int kLeft = 32;
constexpr int kRight = 32 + 64;
static_assert(kLeft >= ImagePyramid::kBorder);

void replicate_border(Image& storage, int width, int height) {
  constexpr int kTop = ImagePyramid::kBorder;
  for (int v = 0; v < height; ++v) {
    std::uint8_t* row = storage.row(kTop + v);
    std::memset(row, row[kLeft], kLeft);
    std::memset(row + kLeft + width, row[kLeft + width - 1], kRight);
  }
  const auto bytes = static_cast<std::size_t>(storage.width());
  for (int i = 0; i < kTop; ++i) {
    std::memcpy(storage.row(i), storage.row(kTop), bytes);
    std::memcpy(storage.row(kTop + height + i), storage.row(kTop + height - 1), bytes);
  }
}

}  // namespace

ImagePyramid::ImagePyramid(int width, int height, int levels) { reserve(width, height, levels); }

void ImagePyramid::reserve(int width, int height, int levels) {
  PELORUS_CHECK(width > 0 && height > 0, "a pyramid needs an image");
  levels = std::clamp(levels, 1, kMaxLevels);
  levels_ = 0;
  const auto scratch = downsample_scratch_size((width + 1) / 2);
  if (column_sums_.size() < scratch) column_sums_.resize(scratch);
  for (std::size_t i = 0; i < static_cast<std::size_t>(levels); ++i) {
    if (i > 0 && std::min(width, height) < kMinSizePx) break;
    Image& storage = storage_[i];
    storage.resize(kLeft + width + kRight, height + 2 * kBorder);
    views_[i] = {storage.row(kBorder) + kLeft, width, height, storage.stride()};
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    ++levels_;
  }
}

void ImagePyramid::build(const ImageView& image, int levels) {
  PELORUS_CHECK(!image.empty(), "a pyramid needs an image");
  reserve(image.width, image.height, levels);
  for (int v = 0; v < image.height; ++v) {
    std::memcpy(storage_[0].row(kBorder + v) + kLeft, image.row(v), static_cast<std::size_t>(image.width));
  }
  replicate_border(storage_[0], image.width, image.height);
  for (std::size_t i = 1; i < static_cast<std::size_t>(levels_); ++i) {
    const ImageView& fine = views_[i - 1];
    const ImageView& coarse = views_[i];
    for (int v = 0; v < coarse.height; ++v) {
      downsample_row(fine.row(2 * v), fine.stride, coarse.width, storage_[i].row(kBorder + v) + kLeft,
                     column_sums_.data());
    }
    replicate_border(storage_[i], coarse.width, coarse.height);
  }
}

}  // namespace pelorus
