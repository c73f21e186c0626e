#include "core/motion/motion_proposal.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "core/geometry/rigid_fit.h"

namespace pelorus {
namespace {

constexpr int kPolishSteps = 2;

// One Gauss-Newton step on the transfer errors of the sample: three points give nine equations for six unknowns.
bool polish(const StereoRig& rig, PointPairs pairs, const std::array<PointIndex, 3>& sample, Rigid3& H) {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (const PointIndex i : sample) {
    const PointPair& pair = pairs[static_cast<std::size_t>(i)];
    const Eigen::Vector3d p_curr = H * pair.prev.p_cam;
    if (!(p_curr.z() > 1e-3)) return false;
    const Eigen::Matrix3d J = rig.project_jacobian(p_curr);
    const Eigen::Matrix3d A = J * H.linear() * rig.triangulate_jacobian(pair.prev.p_cam);
    const Eigen::Matrix3d C_inv = (Eigen::Matrix3d::Identity() + A * A.transpose()).inverse();
    Eigen::Matrix<double, 3, 6> B;
    B.leftCols<3>() = J;
    B.rightCols<3>() = -J * skew(p_curr);
    information += B.transpose() * C_inv * B;
    gradient += B.transpose() * C_inv * (pair.curr.z_px - rig.project(p_curr));
  }
  const Eigen::LDLT<Matrix6d> solver(information);
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-14)) return false;
  const Vector6d xi = solver.solve(gradient);
  if (!(xi.norm() < 1.0)) return false;
  H = se3_exp(xi) * H;
  return true;
}

double truncated_score(const StereoRig& rig, TransferPoints& scored, const Rigid3& H, double gate_chi2) {
  double score = 0;
  for (const double chi2 : scored.chi2(rig, H)) score += std::max(0.0, gate_chi2 - chi2);
  return score;
}

}  // namespace

std::size_t SampleSequence::below(std::size_t bound) {
  state_ += 0x9E3779B97F4A7C15ull;
  std::uint64_t x = state_;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  x ^= x >> 31;
  return static_cast<std::size_t>(x % bound);
}

std::optional<Rigid3> motion_of_three(const StereoRig& rig, PointPairs pairs, const std::array<PointIndex, 3>& sample) {
  std::array<PointMatch, 3> matches;
  for (std::size_t k = 0; k < 3; ++k) {
    const PointPair& pair = pairs[static_cast<std::size_t>(sample[k])];
    matches[k] = {pair.prev.p_cam, pair.curr.p_cam, 1.0};
  }
  std::optional<Rigid3> H = fit_rigid(matches);
  if (!H) return std::nullopt;
  for (int step = 0; step < kPolishSteps; ++step) {
    if (!polish(rig, pairs, sample, *H)) return std::nullopt;
  }
  return H;
}

std::optional<Rigid3> propose_motion(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> members,
                                     std::uint64_t seed, const MotionProposalConfig& config, TransferPoints& scored) {
  if (members.size() < 3) return std::nullopt;
  const auto wanted = static_cast<std::size_t>(config.scored_points);
  scored.assign(rig, pairs, members, std::max<std::size_t>(1, members.size() / wanted));
  SampleSequence sequence(seed);
  std::optional<Rigid3> best;
  double best_score = 0;
  for (int s = 0; s < config.samples; ++s) {
    const std::array<PointIndex, 3> sample{members[sequence.below(members.size())],
                                           members[sequence.below(members.size())],
                                           members[sequence.below(members.size())]};
    if (sample[0] == sample[1] || sample[1] == sample[2] || sample[0] == sample[2]) continue;
    const std::optional<Rigid3> H = motion_of_three(rig, pairs, sample);
    if (!H) continue;
    const double score = truncated_score(rig, scored, *H, config.gate_chi2);
    if (score > best_score) {
      best_score = score;
      best = H;
    }
  }
  return best;
}

}  // namespace pelorus
