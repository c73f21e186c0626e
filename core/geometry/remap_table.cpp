#include "core/geometry/remap_table.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace pelorus {
namespace {

constexpr int kWeightBits = 7;  // 1/128 px: 0.6 grey levels at the steepest edge, under the sensor's noise
constexpr int kOne = 1 << kWeightBits;
constexpr int kRounding = 1 << (2 * kWeightBits - 1);

// The per-frame loop, kept apart so that a vector kernel can replace it; every entry reads inside the raw image.
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

void RemapTable::apply(const ImageView& raw, Image& out) const {
  PELORUS_CHECK(raw.width == raw_width_ && raw.height == raw_height_, "image has another size than the remap table");
  out.resize(width_, height_);
  for (int v = 0; v < height_; ++v) remap_row(&entries_[index(0, v)], width_, raw, out.row(v));
}

Eigen::Vector2d RemapTable::raw_px(int u, int v) const {
  const Entry& e = entries_[index(u, v)];
  return {e.u + static_cast<double>(e.weight_u) / kOne, e.v + static_cast<double>(e.weight_v) / kOne};
}

}  // namespace pelorus
