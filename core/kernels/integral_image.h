#pragma once
// Sums of grey levels over upright rectangles in constant time (Crow 1984; Viola & Jones 2001), for SURF.
// Entry (x, y) is the sum of all pixels (u, v) with u < x and v < y, so x = 0..width, y = 0..height; the rectangle
// [x0, x1) x [y0, y1) sums to at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0). Arithmetic wraps modulo 2^32,
// which leaves every difference right.
// With `phases` P > 1 the columns of a row are stored apart by x mod P, so that every P-th column is contiguous:
// a detector that samples every P-th pixel then loads plain vectors.
// Storage is reserved by the constructor. Thread-bound while building, thread-safe to read. O(pixels).

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/image.h"

namespace pelorus {

// One row of an integral image: `out` = `above` + running sums of the pixels. Column x of both lies at
// (x mod 2^phase_shift) * phase_stride + x / 2^phase_shift; column 0 of both is zero and stays.
struct IntegralRow {
  const std::uint8_t* pixels = nullptr;
  int width = 0;
  int phase_shift = 0;  // 0, 1 or 2
  std::ptrdiff_t phase_stride = 0;
  const std::uint32_t* above = nullptr;
  std::uint32_t* out = nullptr;
};
void integral_row(const IntegralRow& row);

namespace reference {
void integral_row(const IntegralRow& row);
// Columns first + 1 .. width, with `sum` that of the pixels before.
void finish_integral_row(const IntegralRow& row, int first, std::uint32_t sum);
}  // namespace reference

class IntegralImage {
 public:
  // Entries past the end of each phase that may be read (not used) by vector code.
  static constexpr std::ptrdiff_t kSlack = 160;

  IntegralImage(int width, int height, int phases);  // phases 1, 2 or 4

  void build(const ImageView& image);  // of the size given to the constructor

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int phases() const { return 1 << phase_shift_; }
  [[nodiscard]] std::ptrdiff_t stride() const { return stride_; }
  [[nodiscard]] const std::uint32_t* row(int y) const { return sums_.data() + y * stride_; }
  // Place of column x within a row.
  [[nodiscard]] std::ptrdiff_t offset(int x) const {
    return (x & (phases() - 1)) * phase_stride_ + (x >> phase_shift_);
  }
  [[nodiscard]] std::uint32_t at(int x, int y) const { return row(y)[offset(x)]; }

 private:
  int width_;
  int height_;
  int phase_shift_;
  std::ptrdiff_t phase_stride_;
  std::ptrdiff_t stride_;
  std::vector<std::uint32_t> sums_;
};

}  // namespace pelorus
