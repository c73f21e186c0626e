#pragma once
// Identity of a newly formed group with the bodies known before (paper 5.2.4, Fig. 5): the correspondence measure is
// the mismatch |P_G * H_j^-1 - P'| over the carried points, here in deviations; the least mismatch wins if it is
// under the gate and the group lies where the body is. Persistent track ids vote too. Pure. O(group * bodies).

#include "core/objects/moving_body.h"

namespace pelorus {

struct IdentityConfig {
  double gate_chi2_mean = 6.0;  // mean mismatch of the group's points, 3 degrees of freedom each
  double reach_share = 0.3;     // of the body's extent beyond its hull within which a group can belong to it
  double min_reach_m = 0.10;
  double vote_chi2 = 2.0;  // what a unanimous vote of former members takes off the mismatch
};

struct IdentityMatch {
  std::int32_t body = -1;  // index into the bodies, -1 = a new object
  double mismatch = 0;     // mean chi-square of the winner
};

[[nodiscard]] IdentityMatch identify(const StereoRig& rig, PointPairs pairs, const Group& group,
                                     std::span<const MovingBody> bodies, const IdentityConfig& config);

}  // namespace pelorus
