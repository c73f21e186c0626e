#include "core/motion/net_filter.h"

namespace pelorus {

StaticNet::StaticNet(int capacity) : delaunay_(capacity) {
  vertex_of_.reserve(static_cast<std::size_t>(capacity));
  projections_px_.reserve(static_cast<std::size_t>(capacity));
}

void StaticNet::build(PointPairs pairs, std::span<const PointRole> roles) {
  vertex_of_.clear();
  projections_px_.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (roles[i] != PointRole::fixed) continue;
    vertex_of_.push_back(static_cast<PointIndex>(i));
    projections_px_.push_back(pairs[i].curr.z_px.head<2>());
  }
  (void)delaunay_.run(projections_px_);
}

bool StaticNet::surrounding(const Eigen::Vector2d& px, std::array<PointIndex, 3>& vertices) const {
  const int triangle = delaunay_.find(px);
  if (triangle < 0) return false;
  const auto& corners = delaunay_.triangles()[static_cast<std::size_t>(triangle)].vertices;
  for (std::size_t k = 0; k < 3; ++k) vertices[k] = vertex_of_[static_cast<std::size_t>(corners[k])];
  return true;
}

int net_filter(const StaticNet& net, PointPairs pairs, std::span<PointRole> roles) {
  int suspects = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (roles[i] != PointRole::moving) continue;
    std::array<PointIndex, 3> around;
    if (!net.surrounding(pairs[i].curr.z_px.head<2>(), around)) continue;
    for (const PointIndex v : around) {
      PointRole& role = roles[static_cast<std::size_t>(v)];
      suspects += role == PointRole::fixed;
      role = PointRole::suspect;
    }
  }
  return suspects;
}

}  // namespace pelorus
