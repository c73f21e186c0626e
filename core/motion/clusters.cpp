#include "core/motion/clusters.h"

#include <algorithm>
#include <cmath>

#include "core/base/fixed_vector.h"

namespace pelorus {
namespace {

const Eigen::Vector3d& place(PointPairs pairs, PointIndex i) { return pairs[static_cast<std::size_t>(i)].curr.p_cam; }

// Median distance of a member to its nearest other one.
double typical_spacing_m(PointPairs pairs, std::span<const PointIndex> members) {
  FixedVector<double, kMaxPoints> nearest(members.size(), 1e30);
  for (std::size_t m = 0; m < members.size(); ++m) {
    for (const PointIndex b : members) {
      const double square_m2 = (place(pairs, members[m]) - place(pairs, b)).squaredNorm();
      if (b != members[m]) nearest[m] = std::min(nearest[m], square_m2);
    }
  }
  double* const middle = nearest.data() + nearest.size() / 2;
  std::nth_element(nearest.begin(), middle, nearest.end());
  return std::sqrt(*middle);
}

// Renumbers parts by size, largest first; equal sizes keep the order of their first members.
int rank_by_size(std::span<std::int32_t> part, int parts) {
  FixedVector<int, kMaxPoints> size(static_cast<std::size_t>(parts), 0);
  for (const std::int32_t p : part) ++size[static_cast<std::size_t>(p)];
  FixedVector<std::int32_t, kMaxPoints> order(size.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::int32_t>(k);
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    const int size_a = size[static_cast<std::size_t>(a)];
    const int size_b = size[static_cast<std::size_t>(b)];
    return size_a != size_b ? size_a > size_b : a < b;
  });
  FixedVector<std::int32_t, kMaxPoints> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    rank[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);
  for (std::int32_t& p : part) p = rank[static_cast<std::size_t>(p)];
  return parts;
}

}  // namespace

// Single linkage: members nearer than the gap are of one part, and so are their neighbours' neighbours.
int separate_parts(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> members,
                   const ClustersConfig& config, std::span<std::int32_t> part) {
  std::fill(part.begin(), part.end(), -1);
  if (members.size() < 2) {
    std::fill(part.begin(), part.end(), 0);
    return static_cast<int>(members.size());
  }
  const PointPair& first = pairs[static_cast<std::size_t>(members.front())];
  const double sigma_m = rig.depth_sigma_m(first.curr.p_cam.z(), first.sigma_px * std::sqrt(2.0));
  const double gap_m = std::max(
      {config.min_gap_m, config.gap_spacings * typical_spacing_m(pairs, members), config.gap_sigmas * sigma_m});
  int parts = 0;
  FixedVector<std::size_t, kMaxPoints> open;
  for (std::size_t start = 0; start < members.size(); ++start) {
    if (part[start] >= 0) continue;
    part[start] = parts;
    open.assign(1, start);
    while (!open.empty()) {
      const std::size_t a = open.back();
      open.pop_back();
      for (std::size_t b = 0; b < members.size(); ++b) {
        if (part[b] >= 0 || (place(pairs, members[a]) - place(pairs, members[b])).norm() > gap_m) continue;
        part[b] = parts;
        open.push_back(b);
      }
    }
    ++parts;
  }
  return rank_by_size(part, parts);
}

}  // namespace pelorus
