#include "core/motion/two_frame_ba.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/geometry/robust_weight.h"
#include "core/motion/stereo_transfer.h"

namespace pelorus {
namespace {

constexpr double kLeastVariance = 0.01;  // of what the pairs state
constexpr double kLeastCurvature = 0.1;  // of a far point, so that a bad fit's covariance is wide, not negative
// Points for a covariance of six unknowns by their scatter: from so few on it has a say, from so many on it alone.
constexpr double kFewForScatter = 40;
constexpr double kEnoughForScatter = 80;

// One point's contribution to the reduced normal equations.
struct PointTerm {
  Eigen::Vector3d r_prev, r_curr;  // measured - predicted [px]
  Eigen::Matrix3d A;               // d predicted curr / d z_hat
  Eigen::Matrix<double, 3, 6> B;   // d predicted curr / d xi
  double chi2 = 0;
  bool usable = false;
};

PointTerm linearize(const StereoRig& rig, const Rigid3& H, const PointPair& pair, const Eigen::Vector3d& z_hat_px) {
  PointTerm term;
  if (!(z_hat_px.x() > z_hat_px.z())) return term;  // behind or at infinity
  const Eigen::Vector3d p_prev = rig.triangulate(z_hat_px);
  const Eigen::Vector3d p_curr = H * p_prev;
  if (!(p_curr.z() > 1e-3)) return term;
  const Eigen::Matrix3d J = rig.project_jacobian(p_curr);
  term.A = J * H.linear() * rig.triangulate_jacobian(p_prev);
  term.B.leftCols<3>() = J;
  term.B.rightCols<3>() = -J * skew(p_curr);
  term.r_prev = pair.prev.z_px - z_hat_px;
  term.r_curr = pair.curr.z_px - rig.project(p_curr);
  term.chi2 = (term.r_prev.squaredNorm() + term.r_curr.squaredNorm()) / (pair.sigma_px * pair.sigma_px);
  term.usable = true;
  return term;
}

// Reduced normal equations of the motion.
struct Normal {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  Matrix6d curvature = Matrix6d::Zero();  // of the robust cost, points at rest
  Matrix6d scores = Matrix6d::Zero();     // sum of the points' gradients, each times its transpose
  double weighted_chi2 = 0;
  double weight_sum = 0;
};

// Moves the point to its best place under the present motion (its own 3x3 step) and adds its share to the equations.
void accumulate(const StereoRig& rig, const Rigid3& H, const PointPair& pair, double robust_chi2,
                Eigen::Vector3d& z_hat_px, Normal& normal) {
  const PointTerm first = linearize(rig, H, pair, z_hat_px);
  if (!first.usable) return;
  const Eigen::Matrix3d V_first = Eigen::Matrix3d::Identity() + first.A.transpose() * first.A;
  z_hat_px += V_first.inverse() * (first.r_prev + first.A.transpose() * first.r_curr);
  const PointTerm term = linearize(rig, H, pair, z_hat_px);
  if (!term.usable) {
    z_hat_px = pair.prev.z_px;
    return;
  }
  const double w = geman_mcclure_weight(term.chi2, robust_chi2);
  const double w_px = w / (pair.sigma_px * pair.sigma_px);
  const Eigen::Matrix3d V_inv = (Eigen::Matrix3d::Identity() + term.A.transpose() * term.A).inverse();
  const Eigen::Matrix<double, 6, 3> coupling = term.B.transpose() * term.A;
  const Eigen::Matrix<double, 6, 3> W = coupling * V_inv;
  const Matrix6d own = w_px * (term.B.transpose() * term.B - W * coupling.transpose());
  const Vector6d score =
      w_px * (term.B.transpose() * term.r_curr - W * (term.r_prev + term.A.transpose() * term.r_curr));
  normal.information += own;
  normal.gradient += score;
  // Second derivative of Geman-McClure's kernel, mean over the three directions of the residual.
  const double s = term.chi2 / robust_chi2;
  normal.curvature += std::max(kLeastCurvature, 1.0 - 4.0 / 3.0 * s / (1.0 + s)) * own;
  normal.scores += score * score.transpose();
  normal.weighted_chi2 += w * term.chi2;
  normal.weight_sum += w;
}

// Covariance of a robust estimate by what the points themselves say (Huber 1967): where some are much noisier than the
// kernel takes them for, information times one variance promises too much. Six unknowns take as much as two points.
Matrix6d sandwich(const Normal& normal, std::size_t points) {
  const Matrix6d inverse = normal.curvature.inverse();
  const auto n = static_cast<double>(points);
  return n / (n - 2.0) * inverse * (normal.scores + kLeastVariance * normal.information) * inverse;
}

}  // namespace

TwoFrameBa::TwoFrameBa(const TwoFrameBaConfig& config, int capacity) : config_(config) {
  used_.reserve(static_cast<std::size_t>(capacity));
  z_hat_px_.reserve(static_cast<std::size_t>(capacity));
  matches_.reserve(static_cast<std::size_t>(capacity));
}

void TwoFrameBa::align(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> members, MotionFit& fit) {
  matches_.clear();
  for (const PointIndex m : members) {
    const PointPair& pair = pairs[static_cast<std::size_t>(m)];
    if (transfer_chi2(rig, fit.H_curr_prev, pair) < kChi2_3dof_999) {
      matches_.push_back({pair.prev.p_cam, pair.curr.p_cam, 1.0});
    }
  }
  if (const auto aligned = fit_rigid(matches_)) fit.H_curr_prev = *aligned;
}

MotionFit TwoFrameBa::run(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> members,
                          const Rigid3& H_start) {
  MotionFit fit;
  fit.H_curr_prev = H_start;
  if (members.size() < 3) {
    fit.outcome = StageOutcome::too_few_points;
    return fit;
  }
  const auto stride = std::max<std::size_t>(1, (members.size() + static_cast<std::size_t>(config_.max_points) - 1) /
                                                   static_cast<std::size_t>(config_.max_points));
  used_.clear();
  z_hat_px_.clear();
  for (std::size_t i = 0; i < members.size(); i += stride) {
    used_.push_back(members[i]);
    z_hat_px_.push_back(pairs[static_cast<std::size_t>(members[i])].prev.z_px);
  }

  fit.outcome = StageOutcome::not_converged;
  Normal normal;
  for (int iteration = 0; iteration < config_.max_iterations; ++iteration) {
    normal = Normal{};
    for (std::size_t i = 0; i < used_.size(); ++i) {
      accumulate(rig, fit.H_curr_prev, pairs[static_cast<std::size_t>(used_[i])], config_.robust_chi2, z_hat_px_[i],
                 normal);
    }
    const Eigen::LDLT<Matrix6d> solver(normal.information);
    if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-12)) {
      fit.outcome = StageOutcome::degenerate;
      return fit;
    }
    const Vector6d xi = solver.solve(normal.gradient);
    fit.H_curr_prev = se3_exp(xi) * fit.H_curr_prev;
    if (xi.norm() < config_.converged_update) {
      fit.outcome = StageOutcome::ok;
      break;
    }
  }

  // 3 N measurements of the transfer, 6 spent on the motion; the kernel's loss of weight is divided out.
  const double dof = std::max(1.0, 3.0 * normal.weight_sum - 6.0);
  const double variance_scale = normal.weighted_chi2 / dof;
  const double share =
      std::clamp((static_cast<double>(used_.size()) - kFewForScatter) / (kEnoughForScatter - kFewForScatter), 0.0, 1.0);
  fit.cov_H = (1.0 - share) * std::max(kLeastVariance, variance_scale) * normal.information.inverse();
  if (share > 0) fit.cov_H += share * sandwich(normal, used_.size());
  const double sigma_px = pairs[static_cast<std::size_t>(used_.front())].sigma_px;
  fit.rms_px = sigma_px * std::sqrt(variance_scale);
  if (!config_.adjust) align(rig, pairs, members, fit);
  for (const PointIndex m : members) {
    fit.support += transfer_chi2(rig, fit.H_curr_prev, pairs[static_cast<std::size_t>(m)]) < kChi2_3dof_999;
  }
  return fit;
}

}  // namespace pelorus
