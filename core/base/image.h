#pragma once
// 8-bit grey images: Image owns, ImageView looks. Pixel (u, v): u right, v down, integers at pixel centres.
// Rows of an Image start at 64-byte boundaries. Pure.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

namespace pelorus {

struct ImageView {
  const std::uint8_t* pixels = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // bytes from a row to the next

  [[nodiscard]] const std::uint8_t* row(int v) const { return pixels + v * stride; }
  [[nodiscard]] bool empty() const { return pixels == nullptr || width <= 0 || height <= 0; }
};

class Image {
 public:
  Image() = default;
  Image(int width, int height);
  // The image moved from is empty: one that kept its size would never get pixels again.
  Image(Image&& other) noexcept { *this = std::move(other); }
  Image& operator=(Image&& other) noexcept {
    pixels_ = std::move(other.pixels_);
    width_ = std::exchange(other.width_, 0);
    height_ = std::exchange(other.height_, 0);
    stride_ = std::exchange(other.stride_, 0);
    return *this;
  }

  // Keeps the storage when the size is unchanged (no allocation after the first frame).
  void resize(int width, int height);
  // Copies pixels and size from a view; allocates only when the size changes.
  void assign(const ImageView& source);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::ptrdiff_t stride() const { return stride_; }
  [[nodiscard]] bool empty() const { return width_ == 0 || height_ == 0; }
  [[nodiscard]] std::uint8_t* row(int v) { return pixels_.get() + v * stride_; }
  [[nodiscard]] const std::uint8_t* row(int v) const { return pixels_.get() + v * stride_; }
  [[nodiscard]] ImageView view() const { return {pixels_.get(), width_, height_, stride_}; }

 private:
  struct AlignedFree {
    void operator()(std::uint8_t* p) const;
  };
  std::unique_ptr<std::uint8_t[], AlignedFree> pixels_;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

}  // namespace pelorus
