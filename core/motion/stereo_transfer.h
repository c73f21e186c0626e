#pragma once
// The residual on which every motion test rests (method section 2): a stereo measurement carried through a
// motion, compared in pixels, divided by its own standard deviation. No threshold is in metres.
// Pure, no allocation, O(1). Matthies & Shafer 1987; Geiger et al. 2011.

#include "core/model/stage_data.h"

namespace pelorus {

// Chi-square quantiles for the 3 degrees of freedom of a stereo transfer.
inline constexpr double kChi2_3dof_950 = 7.815;
inline constexpr double kChi2_3dof_990 = 11.345;
inline constexpr double kChi2_3dof_999 = 16.266;

// Squared Mahalanobis distance of z_b_px from the transfer of z_a_px by T_b_a; both measured with deviation
// sigma_px per coordinate. 3 degrees of freedom. Infinite (1e12) where the motion says nothing of the
// point: behind the camera, or right beside its centre.
[[nodiscard]] double transfer_chi2(const StereoRig& rig, const Rigid3& T_b_a, const Eigen::Vector3d& z_a_px,
                                   const Eigen::Vector3d& z_b_px, double sigma_px);

[[nodiscard]] inline double transfer_chi2(const StereoRig& rig, const Rigid3& H_curr_prev, const PointPair& pair) {
  return transfer_chi2(rig, H_curr_prev, pair.prev.z_px, pair.curr.z_px, pair.sigma_px);
}

}  // namespace pelorus
