#include "core/motion/rigidity.h"

#include <algorithm>
#include <cmath>

namespace pelorus {
namespace {

struct Length {
  double value_m = 0;
  double variance_m2 = 0;
};

// Distance between two points of one stereo pair and its variance from pixel noise.
Length length_between(const StereoRig& rig, const Eigen::Vector3d& z_a_px, const Eigen::Vector3d& z_b_px,
                      double sigma_a_px, double sigma_b_px) {
  const Eigen::Vector3d p_a = rig.triangulate(z_a_px);
  const Eigen::Vector3d p_b = rig.triangulate(z_b_px);
  const Eigen::Vector3d r = p_a - p_b;
  Length length;
  length.value_m = r.norm();
  if (length.value_m < 1e-9) return length;
  const Eigen::Vector3d direction = r / length.value_m;
  length.variance_m2 = sigma_a_px * sigma_a_px * (rig.triangulate_jacobian(p_a).transpose() * direction).squaredNorm() +
                       sigma_b_px * sigma_b_px * (rig.triangulate_jacobian(p_b).transpose() * direction).squaredNorm();
  return length;
}

const Eigen::Vector3d& measured_back(const PointPair& pair, int frames_back) {
  return frames_back == 1 ? pair.prev.z_px : pair.past[static_cast<std::size_t>(frames_back - 2)];
}

}  // namespace

RigidityEvidence rigidity(const StereoRig& rig, const PointPair& seed, const PointPair& point) {
  const Length now = length_between(rig, seed.curr.z_px, point.curr.z_px, seed.sigma_px, point.sigma_px);
  RigidityEvidence worst;
  double worst_significance = -1;
  const int longest = 1 + std::min(seed.past_size, point.past_size);
  const int strides[2] = {1, longest};  // the step itself, and the longest history both share
  for (int s = 0; s < (longest > 1 ? 2 : 1); ++s) {
    const Length then = length_between(rig, measured_back(seed, strides[s]), measured_back(point, strides[s]),
                                       seed.sigma_px, point.sigma_px);
    const double change_m = std::abs(now.value_m - then.value_m);
    const double variance_m2 = std::max(1e-18, now.variance_m2 + then.variance_m2);
    const double significance = change_m * change_m / variance_m2;
    if (significance <= worst_significance) continue;
    worst_significance = significance;
    worst.change_m = change_m;
    worst.sigma_m = std::sqrt(variance_m2);
    worst.cost = significance + std::log(variance_m2);
  }
  return worst;
}

}  // namespace pelorus
