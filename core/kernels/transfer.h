#pragma once
// Stereo transfer of many points by one motion: the Mahalanobis square of what a point's second measurement differs by
// from its first one carried over, with the noise of both measurements (method section 4). The inner loop of grouping.
// Vector paths equal the reference bit by bit: one point per lane, no fused operations. Pure. No allocation. O(points).

#include <cstddef>

namespace pelorus {

// Columns of `size` points, which is a multiple of kTransferLanes (pad with any finite point of positive depth).
struct TransferColumns {
  const double* x_m = nullptr;  // triangulated first measurement
  const double* y_m = nullptr;
  const double* z_m = nullptr;
  const double* m_per_px = nullptr;       // z / f
  const double* per_disparity = nullptr;  // 1 / disparity, 1/px
  const double* u_left_px = nullptr;      // second measurement
  const double* v_px = nullptr;
  const double* u_right_px = nullptr;
  const double* per_variance = nullptr;  // 1 / sigma^2, 1/px^2
  std::size_t size = 0;
};
inline constexpr std::size_t kTransferLanes = 8;

// p_b = r * p_a + t, r row by row; f, c in pixels.
struct TransferMotion {
  double r[9];
  double t[3];
  double f_px;
  double cx_px;
  double cy_px;
  double baseline_m;
};

// Of a point that the motion carries behind the camera or to where it says nothing: beside the camera's centre the
// covariance of the residual grows without bound, and its inverse is rounding errors that may even be negative.
inline constexpr double kImpossibleChi2 = 1e12;
inline constexpr double kLeastTransferDepth_m = 1e-3;
inline constexpr double kLargestTransferSpread = 1e6;  // trace of the residual's covariance over the measurement's

// chi2[i] has 3 degrees of freedom.
void transfer_chi2(const TransferMotion& motion, const TransferColumns& points, double* chi2);

namespace reference {
void transfer_chi2(const TransferMotion& motion, const TransferColumns& points, double* chi2);
}

}  // namespace pelorus
