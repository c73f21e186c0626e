#include "core/motion/repartition.h"

#include <algorithm>
#include <cmath>

#include "core/motion/stereo_transfer.h"

namespace pelorus {

double static_chi2(const StereoRig& rig, const PointPair& pair, const StaticMotions& motions) {
  double chi2 = transfer_chi2(rig, motions.T_curr_past[0], pair);
  const int longest = std::min(pair.past_size, motions.size - 1);
  if (longest > 0) {
    // A patch drifts over frames like a random walk, so its deviation grows with the root of their number.
    const Eigen::Vector3d& z_then_px = pair.past[static_cast<std::size_t>(longest - 1)];
    chi2 = std::max(chi2, transfer_chi2(rig, motions.T_curr_past[static_cast<std::size_t>(longest)], z_then_px,
                                        pair.curr.z_px, pair.sigma_px * std::sqrt(1.0 + longest)));
  }
  return chi2;
}

void repartition(const StereoRig& rig, PointPairs pairs, const StaticMotions& motions, const RepartitionConfig& config,
                 std::span<PointRole> roles, std::span<double> chi2_static) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    chi2_static[i] = static_chi2(rig, pairs[i], motions);
    const BodyId before = pairs[i].previous_body;
    const double gate = before == kWorldBody ? config.stay_chi2
                        : before == kNoBody  ? config.join_chi2
                                             : config.return_chi2;
    roles[i] = chi2_static[i] < gate ? PointRole::fixed : PointRole::moving;
  }
}

}  // namespace pelorus
