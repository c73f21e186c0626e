#include "core/geometry/remap_table.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace pelorus {
namespace {

constexpr int kWeightBits =
    kRemapWeightBits;  // 1/128 px: 0.6 grey levels at the steepest edge, under the sensor's noise
constexpr int kOne = 1 << kWeightBits;
constexpr int kRounding = 1 << (2 * kWeightBits - 1);

// Pixels of no block, one by one; every entry reads inside the raw image.
void remap_row(const RemapTable::Entry* entries, int count, const ImageView& raw, std::uint8_t* out) {
  for (int i = 0; i < count; ++i) {
    const RemapTable::Entry e = entries[i];
    if (e.u < 0) {
      out[i] = 0;
      continue;
    }
    const std::uint8_t* upper = raw.pixels + e.v * raw.stride + e.u;
    const std::uint8_t* lower = upper + raw.stride;
    const int top = upper[0] * (kOne - e.weight_u) + upper[1] * e.weight_u;
    const int bottom = lower[0] * (kOne - e.weight_u) + lower[1] * e.weight_u;
    out[i] =
        static_cast<std::uint8_t>((top * (kOne - e.weight_v) + bottom * e.weight_v + kRounding) >> (2 * kWeightBits));
  }
}

}  // namespace

RemapTable::RemapTable(int width, int height, int raw_width, int raw_height)
    : width_(width), height_(height), raw_width_(raw_width), raw_height_(raw_height) {
  PELORUS_CHECK(width > 0 && height > 0, "a remap table needs an output size");
  PELORUS_CHECK(raw_width > 1 && raw_height > 1 && raw_width <= 32767 && raw_height <= 32767,
                "input sides of a remap table are 2 to 32767");
  entries_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int v = 0; v < height; ++v) rest_.push_back({0, v, width});
}

void RemapTable::set(int u, int v, const Eigen::Vector2d& raw_px) {
  Entry& e = entries_[index(u, v)];
  e = Entry{};
  const bool inside =
      raw_px.x() >= -0.5 && raw_px.x() <= raw_width_ - 0.5 && raw_px.y() >= -0.5 && raw_px.y() <= raw_height_ - 0.5;
  if (!inside) return;
  const int fixed_u = std::clamp(static_cast<int>(std::lround(raw_px.x() * kOne)), 0, (raw_width_ - 1) * kOne);
  const int fixed_v = std::clamp(static_cast<int>(std::lround(raw_px.y() * kOne)), 0, (raw_height_ - 1) * kOne);
  // The last column and row are reached with full weight from the one before: no read past the image.
  const int base_u = std::min(fixed_u >> kWeightBits, raw_width_ - 2);
  const int base_v = std::min(fixed_v >> kWeightBits, raw_height_ - 2);
  e.u = static_cast<std::int16_t>(base_u);
  e.v = static_cast<std::int16_t>(base_v);
  e.weight_u = static_cast<std::uint8_t>(fixed_u - base_u * kOne);
  e.weight_v = static_cast<std::uint8_t>(fixed_v - base_v * kOne);
}

bool RemapTable::gather(int u, int v, RemapBlock& block) const {
  const Entry* first = &entries_[index(u, v)];
  int first_u = raw_width_ - kRemapWindowColumns;  // of a window inside the image
  int first_v = raw_height_ - kRemapWindowRows;
  if (first_u < 0 || first_v < 0) return false;
  for (int i = 0; i < kRemapBlock; ++i) {
    if (first[i].u < 0) continue;
    first_u = std::min(first_u, static_cast<int>(first[i].u));
    first_v = std::min(first_v, static_cast<int>(first[i].v));
  }
  block = RemapBlock{};
  block.out_u = static_cast<std::int16_t>(u);
  block.out_v = static_cast<std::int16_t>(v);
  block.u = static_cast<std::int16_t>(first_u);
  block.v = static_cast<std::int16_t>(first_v);
  for (std::size_t i = 0; i < kRemapBlock; ++i) {
    const Entry& e = first[i];
    const int column = e.u - first_u;
    const int row = e.v - first_v;
    block.column[i] = RemapBlock::kBlack;
    if (e.u < 0) continue;
    if (column + 1 >= kRemapWindowColumns || row + 1 >= kRemapWindowRows) return false;
    block.column[i] = static_cast<std::uint8_t>(column);
    block.lower[i] = static_cast<std::int8_t>(-row);
    block.weight_u[i] = e.weight_u;
    block.weight_v[i] = e.weight_v;
  }
  return true;
}

void RemapTable::finish() {
  blocks_.clear();
  rest_.clear();
  RemapBlock block;
  for (int v = 0; v < height_; ++v) {
    int u = 0;
    while (u < width_) {
      // The last block of a row overlaps the one before.
      const int start = width_ >= kRemapBlock ? std::min(u, width_ - kRemapBlock) : u;
      if (width_ >= kRemapBlock && gather(start, v, block)) {
        blocks_.push_back(block);
      } else {
        rest_.push_back({u, v, std::min(kRemapBlock, width_ - u)});
      }
      u += kRemapBlock;
    }
  }
}

void RemapTable::apply(const ImageView& raw, Image& out) const {
  PELORUS_CHECK(raw.width == raw_width_ && raw.height == raw_height_, "image has another size than the remap table");
  out.resize(width_, height_);
  remap(blocks_, raw, out.stride(), out.row(0));
  for (const Rest& r : rest_) remap_row(&entries_[index(r.u, r.v)], r.count, raw, out.row(r.v) + r.u);
}

Eigen::Vector2d RemapTable::raw_px(int u, int v) const {
  const Entry& e = entries_[index(u, v)];
  return {e.u + static_cast<double>(e.weight_u) / kOne, e.v + static_cast<double>(e.weight_v) / kOne};
}

}  // namespace pelorus
