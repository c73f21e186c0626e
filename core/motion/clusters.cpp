#include "core/motion/clusters.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pelorus {
namespace {

const Eigen::Vector3d& place(PointPairs pairs, PointIndex i) { return pairs[static_cast<std::size_t>(i)].curr.p_cam; }

// Median distance of a member to its nearest other one.
double typical_spacing_m(PointPairs pairs, std::span<const PointIndex> members) {
  std::vector<double> nearest;
  for (const PointIndex a : members) {
    double best = 1e30;
    for (const PointIndex b : members) {
      if (a != b) best = std::min(best, (place(pairs, a) - place(pairs, b)).squaredNorm());
    }
    nearest.push_back(best);
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return std::sqrt(*middle);
}

// Renumbers parts by size, largest first; equal sizes keep the order of their first members.
int rank_by_size(std::span<std::int32_t> part, int parts) {
  std::vector<int> size(static_cast<std::size_t>(parts), 0);
  for (const std::int32_t p : part) ++size[static_cast<std::size_t>(p)];
  std::vector<std::int32_t> order(size.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::int32_t>(k);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return size[static_cast<std::size_t>(a)] > size[static_cast<std::size_t>(b)];
  });
  std::vector<std::int32_t> rank(order.size());
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
  std::vector<std::size_t> open;
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
