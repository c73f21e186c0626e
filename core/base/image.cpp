#include "core/base/image.h"

#include <cstdlib>
#include <cstring>

#include "core/base/check.h"

namespace pelorus {
namespace {
constexpr std::ptrdiff_t kRowAlignment = 64;  // one cache line, one AVX-512 vector
}

void Image::AlignedFree::operator()(std::uint8_t* p) const { std::free(p); }

Image::Image(int width, int height) { resize(width, height); }

void Image::resize(int width, int height) {
  PELORUS_CHECK(width >= 0 && height >= 0, "image size must not be negative");
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  stride_ = (width + kRowAlignment - 1) / kRowAlignment * kRowAlignment;
  // One vector of slack after the last row: SIMD loads may read past the row end, never use it.
  const auto bytes = static_cast<std::size_t>(stride_ * height + kRowAlignment);
  pixels_.reset(static_cast<std::uint8_t*>(std::aligned_alloc(kRowAlignment, bytes)));
  PELORUS_CHECK(pixels_ != nullptr, "out of memory for an image");
  std::memset(pixels_.get(), 0, bytes);
}

void Image::assign(const ImageView& source) {
  resize(source.width, source.height);
  for (int v = 0; v < height_; ++v) std::memcpy(row(v), source.row(v), static_cast<std::size_t>(width_));
}

}  // namespace pelorus
