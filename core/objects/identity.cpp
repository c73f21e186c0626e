#include "core/objects/identity.h"

#include <algorithm>

#include "core/motion/stereo_transfer.h"

namespace pelorus {
namespace {

Eigen::Vector3d median_point(PointPairs pairs, const Group& group) {
  Eigen::Vector3d median;
  std::vector<double> values(group.members.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t m = 0; m < values.size(); ++m) {
      values[m] = pairs[static_cast<std::size_t>(group.members[m])].prev.p_cam[axis];
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[axis] = *middle;
  }
  return median;
}

}  // namespace

IdentityMatch identify(const StereoRig& rig, PointPairs pairs, const Group& group, std::span<const MovingBody> bodies,
                       const IdentityConfig& config) {
  IdentityMatch match;
  double best = config.gate_chi2_mean;
  const Eigen::Vector3d center = median_point(pairs, group);
  for (std::size_t j = 0; j < bodies.size(); ++j) {
    const MovingBody& body = bodies[j];
    if (!body.measured) continue;  // bodies out of sight are re-identified, not continued
    const double distance_m = (center - body.T_cam_obj * body.centroid_obj).norm();
    const double reach_m = std::max(config.min_reach_m, (0.5 + config.reach_share) * body.extent_m.norm());
    if (distance_m > reach_m) continue;
    double sum = 0;
    double votes = 0;
    for (const PointIndex i : group.members) {
      const PointPair& pair = pairs[static_cast<std::size_t>(i)];
      sum += std::min(50.0, transfer_chi2(rig, body.H_curr_prev, pair));
      votes += pair.previous_body == body.id;
    }
    const auto count = static_cast<double>(group.members.size());
    const double mismatch = sum / count - config.vote_chi2 * votes / count;
    if (mismatch >= best) continue;
    best = mismatch;
    match.body = static_cast<std::int32_t>(j);
    match.mismatch = mismatch;
  }
  return match;
}

}  // namespace pelorus
