#include "core/objects/identity.h"

#include <algorithm>

#include "core/base/fixed_vector.h"
#include "core/geometry/hull.h"
#include "core/motion/stereo_transfer.h"

namespace pelorus {
namespace {

// Least distance of the group's points from the hull of the body's, at the previous position.
double gap_to_body(PointPairs pairs, const Group& group, const MovingBody& body) {
  FixedVector<Eigen::Vector3d, kMaxPoints> hull;
  for (const PointIndex i : body.members) hull.push_back(pairs[static_cast<std::size_t>(i)].prev.p_cam);
  double least_m = 1e30;
  for (const PointIndex i : group.members) {
    least_m = std::min(least_m, distance_to_hull(hull, pairs[static_cast<std::size_t>(i)].prev.p_cam));
  }
  return least_m;
}

}  // namespace

IdentityMatch identify(const StereoRig& rig, PointPairs pairs, const Group& group, std::span<const MovingBody> bodies,
                       const IdentityConfig& config) {
  IdentityMatch match;
  double best = config.gate_chi2_mean;
  for (std::size_t j = 0; j < bodies.size(); ++j) {
    const MovingBody& body = bodies[j];
    if (!body.measured) continue;  // bodies out of sight are re-identified, not continued
    const double reach_m = std::max(config.min_reach_m, config.reach_share * body.extent_m.norm());
    if (gap_to_body(pairs, group, body) > reach_m) continue;
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
