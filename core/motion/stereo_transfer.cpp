#include "core/motion/stereo_transfer.h"

#include <Eigen/LU>

#include "core/kernels/transfer.h"

namespace pelorus {

double transfer_chi2(const StereoRig& rig, const Rigid3& T_b_a, const Eigen::Vector3d& z_a_px,
                     const Eigen::Vector3d& z_b_px, double sigma_px) {
  const Eigen::Vector3d p_a = rig.triangulate(z_a_px);
  const Eigen::Vector3d p_b = T_b_a * p_a;
  if (!(p_b.z() > kLeastTransferDepth_m)) return kImpossibleChi2;
  const Eigen::Vector3d residual_px = z_b_px - rig.project(p_b);
  // d z_b / d z_a = d project / d p_b * R_b_a * d triangulate / d z_a.
  const Eigen::Matrix3d A = rig.project_jacobian(p_b) * T_b_a.linear() * rig.triangulate_jacobian(p_a);
  Eigen::Matrix3d C = A * A.transpose();
  C.diagonal().array() += 1.0;
  if (!(C.trace() <= kLargestTransferSpread)) return kImpossibleChi2;
  return residual_px.dot(C.inverse() * residual_px) / (sigma_px * sigma_px);
}

}  // namespace pelorus
