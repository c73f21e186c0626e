#include "core/motion/transfer_points.h"

namespace pelorus {
namespace {

std::size_t padded(std::size_t points) { return (points + kTransferLanes - 1) / kTransferLanes * kTransferLanes; }

}  // namespace

void TransferPoints::reserve(std::size_t points) {
  columns_.reserve(kColumns * padded(points));
  chi2_.reserve(padded(points));
}

void TransferPoints::assign(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> chosen,
                            std::size_t stride) {
  size_ = (chosen.size() + stride - 1) / stride;
  padded_ = padded(size_);
  columns_.assign(kColumns * padded_, 1.0);
  chi2_.resize(padded_);
  for (std::size_t i = 0; i < size_; ++i) {
    const PointPair& pair = pairs[static_cast<std::size_t>(chosen[i * stride])];
    const Eigen::Vector3d& p = pair.prev.p_cam;
    column(0)[i] = p.x();
    column(1)[i] = p.y();
    column(2)[i] = p.z();
    column(3)[i] = p.z() / rig.f_px;
    column(4)[i] = p.z() / (rig.f_px * rig.baseline_m);
    for (int k = 0; k < 3; ++k) column(5 + static_cast<std::size_t>(k))[i] = pair.curr.z_px[k];
    column(8)[i] = 1.0 / (pair.sigma_px * pair.sigma_px);
  }
}

std::span<const double> TransferPoints::chi2(const StereoRig& rig, const Rigid3& H_curr_prev) {
  TransferMotion motion{};
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) motion.r[3 * row + k] = H_curr_prev.linear()(row, k);
    motion.t[row] = H_curr_prev.translation()[row];
  }
  motion.f_px = rig.f_px;
  motion.cx_px = rig.cx_px;
  motion.cy_px = rig.cy_px;
  motion.baseline_m = rig.baseline_m;
  const TransferColumns columns{column(0), column(1), column(2), column(3), column(4),
                                column(5), column(6), column(7), column(8), padded_};
  transfer_chi2(motion, columns, chi2_.data());
  return {chi2_.data(), size_};
}

}  // namespace pelorus
