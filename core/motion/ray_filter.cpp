#include "core/motion/ray_filter.h"

#include <cmath>

namespace pelorus {
namespace {

double depth_sigma(const StereoRig& rig, const PointPair& pair) {
  return rig.depth_sigma_m(pair.curr.p_cam.z(), pair.sigma_px * std::sqrt(2.0));
}

// Whether P_k lies on the surface patch through the three static points, within the propagated depth error.
bool adjoins(const StereoRig& rig, const PointPair& point, const PointPair& a, const PointPair& b, const PointPair& c,
             double gate_sigmas) {
  const Eigen::Vector3d normal = (b.curr.p_cam - a.curr.p_cam).cross(c.curr.p_cam - a.curr.p_cam);
  const double along = normal.dot(point.curr.p_cam);
  if (std::abs(along) < 1e-12) return false;
  const double scale = normal.dot(a.curr.p_cam) / along;  // P_int = scale * P_k
  const double distance_m = std::abs(scale - 1.0) * point.curr.p_cam.norm();
  const double variance_m2 =
      std::pow(depth_sigma(rig, point), 2) +
      (std::pow(depth_sigma(rig, a), 2) + std::pow(depth_sigma(rig, b), 2) + std::pow(depth_sigma(rig, c), 2)) / 3.0;
  return distance_m < gate_sigmas * std::sqrt(variance_m2);
}

}  // namespace

int ray_filter(const StereoRig& rig, const StaticNet& net, PointPairs pairs, std::span<const double> chi2_static,
               const RayFilterConfig& config, std::span<PointRole> roles) {
  int removed = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (roles[i] != PointRole::moving || pairs[i].previous_body > kWorldBody) continue;
    if (pairs[i].past_size >= config.conclusive_history && chi2_static[i] > config.conclusive_chi2) continue;
    std::array<PointIndex, 3> around;
    if (!net.surrounding(pairs[i].curr.z_px.head<2>(), around)) continue;
    if (!adjoins(rig, pairs[i], pairs[static_cast<std::size_t>(around[0])], pairs[static_cast<std::size_t>(around[1])],
                 pairs[static_cast<std::size_t>(around[2])], config.gate_sigmas)) {
      continue;
    }
    roles[i] = PointRole::outlier;
    ++removed;
  }
  return removed;
}

}  // namespace pelorus
