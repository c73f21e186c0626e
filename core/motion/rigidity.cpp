#include "core/motion/rigidity.h"

#include <algorithm>
#include <cmath>

namespace pelorus {
namespace {

struct Length {
  double value_m = 0;
  double variance_m2 = 0;
};

// |J^T r|^2 for the Jacobian J of the triangulation at `place` (StereoRig::triangulate_jacobian): its columns are
// q + m e_x, m e_y and -q with q = -p / disparity.
double spread_along(const PointHistory::Place& place, const Eigen::Vector3d& r) {
  const double q = -place.per_disparity * place.p_cam.dot(r);
  const double left = q + place.m_per_px * r.x();
  const double row = place.m_per_px * r.y();
  return left * left + row * row + q * q;
}

Length length_between(const PointHistory& a, const PointHistory& b, int frames_back) {
  const PointHistory::Place& place_a = a.places[static_cast<std::size_t>(frames_back)];
  const PointHistory::Place& place_b = b.places[static_cast<std::size_t>(frames_back)];
  const Eigen::Vector3d r = place_a.p_cam - place_b.p_cam;
  const double square_m2 = r.squaredNorm();
  if (square_m2 < 1e-18) return {};
  const double spread = a.variance_px2 * spread_along(place_a, r) + b.variance_px2 * spread_along(place_b, r);
  return {std::sqrt(square_m2), spread / square_m2};
}

}  // namespace

PointHistory history_of(const StereoRig& rig, const PointPair& pair) {
  PointHistory history;
  history.variance_px2 = pair.sigma_px * pair.sigma_px;
  const auto add = [&](const Eigen::Vector3d& z_px) {
    const Eigen::Vector3d p_cam = rig.triangulate(z_px);
    history.places[static_cast<std::size_t>(history.size++)] = {p_cam, p_cam.z() / rig.f_px,
                                                                1.0 / (z_px.x() - z_px.z())};
  };
  add(pair.curr.z_px);
  add(pair.prev.z_px);
  for (int k = 0; k < pair.past_size; ++k) add(pair.past[static_cast<std::size_t>(k)]);
  return history;
}

RigidityEvidence rigidity(const PointHistory& seed, const PointHistory& point) {
  const Length now = length_between(seed, point, 0);
  RigidityEvidence worst;
  double worst_significance = -1;
  const int longest = std::min(seed.size, point.size) - 1;
  const int strides[2] = {1, longest};  // the step itself, and the longest history both share
  for (int s = 0; s < (longest > 1 ? 2 : 1); ++s) {
    const Length then = length_between(seed, point, strides[s]);
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
