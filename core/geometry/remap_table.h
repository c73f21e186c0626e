#pragma once
// RemapTable: where each pixel of an output image comes from in an input image, with bilinear weights in fixed point.
// apply() is the per-frame cost of rectification. Pure once built: apply() may run on several threads.
// Nearly all pixels go in blocks of eight through a vector kernel (core/kernels/remap.h), the others one by one, with
// the same bits. Memory: 11 bytes a pixel; apply allocates only when the output's size changes.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/kernels/remap.h"

namespace pelorus {

class RemapTable {
 public:
  RemapTable() = default;
  RemapTable(int width, int height, int raw_width, int raw_height);

  // Output pixel (u, v) comes from raw_px; outside the raw image (by more than half a pixel) it stays black.
  void set(int u, int v, const Eigen::Vector2d& raw_px);
  // After the last set(): gathers the blocks. Without it apply() is right, but slow.
  void finish();
  void apply(const ImageView& raw, Image& out) const;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::size_t blocks() const { return blocks_.size(); }
  [[nodiscard]] bool covered(int u, int v) const { return entries_[index(u, v)].u >= 0; }
  // Input position of an output pixel as the fixed-point table has it; for tests and pictures.
  [[nodiscard]] Eigen::Vector2d raw_px(int u, int v) const;

  struct Entry {
    std::int16_t u = -1;  // upper left of the four input pixels; -1: nothing to see there
    std::int16_t v = -1;
    std::uint8_t weight_u = 0;  // of the right and lower neighbours, in 1/128
    std::uint8_t weight_v = 0;
  };

 private:
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
  }

  // Eight neighbouring entries as a block; false where they are too far apart.
  [[nodiscard]] bool gather(int u, int v, RemapBlock& block) const;

  int width_ = 0;
  int height_ = 0;
  int raw_width_ = 0;
  int raw_height_ = 0;
  std::vector<Entry> entries_;
  std::vector<RemapBlock> blocks_;
  struct Rest {
    int u = 0;
    int v = 0;
    int count = 0;
  };
  std::vector<Rest> rest_;  // pixels of no block
};

}  // namespace pelorus
