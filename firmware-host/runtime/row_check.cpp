#include "firmware-host/runtime/row_check.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace pelorus {
namespace {

constexpr int kHalf = 5;             // patches of 11x11
constexpr int kGrid = 24;            // distance between patches
constexpr int kRowRange = 4;         // rows searched above and below
constexpr double kMinScore = 0.92;   // normalised correlation of a find
constexpr double kMinScatter = 6.0;  // grey levels: less is noise

struct Patch {
  double mean = 0;
  double norm = 0;  // of the deviations from the mean
};

Patch patch_at(const ImageView& image, int u, int v) {
  int sum = 0;
  int squares = 0;
  for (int y = -kHalf; y <= kHalf; ++y) {
    const std::uint8_t* row = image.row(v + y) + u;
    for (int x = -kHalf; x <= kHalf; ++x) {
      sum += row[x];
      squares += row[x] * row[x];
    }
  }
  constexpr double kCount = (2 * kHalf + 1) * (2 * kHalf + 1);
  const double mean = sum / kCount;
  return {mean, std::sqrt(std::max(0.0, squares - kCount * mean * mean))};
}

double correlation(const ImageView& left, int u_l, int v_l, const Patch& a, const ImageView& right, int u_r, int v_r) {
  const Patch b = patch_at(right, u_r, v_r);
  if (b.norm < 1.0) return 0;
  int products = 0;
  for (int y = -kHalf; y <= kHalf; ++y) {
    const std::uint8_t* row_l = left.row(v_l + y) + u_l;
    const std::uint8_t* row_r = right.row(v_r + y) + u_r;
    for (int x = -kHalf; x <= kHalf; ++x) products += row_l[x] * row_r[x];
  }
  constexpr double kCount = (2 * kHalf + 1) * (2 * kHalf + 1);
  return (products - kCount * a.mean * b.mean) / (a.norm * b.norm);
}

// Row offset of the patch in the right image, to a fraction of a pixel.
std::optional<double> row_offset(const ImageView& left, const ImageView& right, int u, int v) {
  const Patch patch = patch_at(left, u, v);
  if (patch.norm < kMinScatter * (2 * kHalf + 1)) return std::nullopt;
  const int max_disparity = std::min(u - kHalf, left.width / 5);
  double best = kMinScore;
  int best_d = -1;
  int best_dv = 0;
  for (int dv = -kRowRange; dv <= kRowRange; ++dv) {
    for (int d = 0; d <= max_disparity; ++d) {
      const double score = correlation(left, u, v, patch, right, u - d, v + dv);
      if (score <= best) continue;
      best = score;
      best_d = d;
      best_dv = dv;
    }
  }
  if (best_d < 0 || std::abs(best_dv) == kRowRange) return std::nullopt;
  const double above = correlation(left, u, v, patch, right, u - best_d, v + best_dv - 1);
  const double below = correlation(left, u, v, patch, right, u - best_d, v + best_dv + 1);
  const double curvature = above - 2 * best + below;
  // An edge that runs down the image looks the same on every row and says nothing about rows.
  if (curvature > -0.05) return std::nullopt;
  return best_dv + 0.5 * (above - below) / curvature;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

RowAgreement measure_rows(const ImageView& left, const ImageView& right) {
  std::vector<double> offsets;
  const int border = kHalf + kRowRange + 1;
  for (int v = border; v < left.height - border; v += kGrid)
    for (int u = border; u < left.width - border; u += kGrid)
      if (const auto offset = row_offset(left, right, u, v)) offsets.push_back(*offset);
  RowAgreement out;
  out.patches = static_cast<int>(offsets.size());
  if (offsets.empty()) return out;
  out.median_px = median(offsets);
  for (double& offset : offsets) offset = std::abs(offset - out.median_px);
  out.spread_px = median(offsets);
  return out;
}

}  // namespace pelorus
