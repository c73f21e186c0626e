#include "core/evaluation/trajectory_error.h"

#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <numbers>

namespace pelorus {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
// Geiger et al. 2012: sub-path lengths; a start every tenth frame.
constexpr std::array<double, 8> kSubPathLengths_m = {100, 200, 300, 400, 500, 600, 700, 800};
constexpr std::size_t kSubPathStartStep = 10;
// Below this a ratio of drift to length says nothing: the vehicle stood still.
constexpr double kShortestPath_m = 0.5;

// Translation RMSE after the rigid motion that fits the estimated positions best to the true ones (Umeyama 1991).
double ate_rmse(const std::vector<PosePair>& poses) {
  Eigen::Vector3d mean_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_truth = Eigen::Vector3d::Zero();
  const auto count = static_cast<double>(poses.size());
  for (const PosePair& pose : poses) {
    mean_world += pose.T_world_cam.translation() / count;
    mean_truth += pose.T_truth_cam.translation() / count;
  }
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const PosePair& pose : poses) {
    correlation += (pose.T_truth_cam.translation() - mean_truth) *
                   (pose.T_world_cam.translation() - mean_world).transpose() / count;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
  const Eigen::Matrix3d R_truth_world = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  double sum_of_squares = 0;
  for (const PosePair& pose : poses) {
    const Eigen::Vector3d aligned = R_truth_world * (pose.T_world_cam.translation() - mean_world) + mean_truth;
    sum_of_squares += (aligned - pose.T_truth_cam.translation()).squaredNorm();
  }
  return std::sqrt(sum_of_squares / count);
}

// Error of the estimated motion from pose a to pose b, seen in the true camera at b.
Rigid3 relative_error(const PosePair& a, const PosePair& b) {
  const Rigid3 step_true = a.T_truth_cam.inverse() * b.T_truth_cam;
  const Rigid3 step_estimated = a.T_world_cam.inverse() * b.T_world_cam;
  return step_true.inverse() * step_estimated;
}

// Distance travelled up to each pose.
std::vector<double> path_lengths(const std::vector<PosePair>& poses) {
  std::vector<double> length_m(poses.size(), 0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length_m[i] =
        length_m[i - 1] + (poses[i].T_truth_cam.translation() - poses[i - 1].T_truth_cam.translation()).norm();
  }
  return length_m;
}

std::optional<SubPathDrift> sub_path_drift(const std::vector<PosePair>& poses, const std::vector<double>& length_m) {
  SubPathDrift drift;
  for (std::size_t first = 0; first < poses.size(); first += kSubPathStartStep) {
    std::size_t last = first;
    for (const double wanted_m : kSubPathLengths_m) {
      while (last < poses.size() && length_m[last] - length_m[first] < wanted_m) ++last;
      if (last == poses.size()) break;
      const Rigid3 error = relative_error(poses[first], poses[last]);
      drift.translation_percent += 100.0 * error.translation().norm() / wanted_m;
      drift.rotation_deg_per_100m += 100.0 * kDegPerRad * rotation_angle_rad(error.linear()) / wanted_m;
      ++drift.count;
    }
  }
  if (drift.count == 0) return std::nullopt;
  drift.translation_percent /= static_cast<double>(drift.count);
  drift.rotation_deg_per_100m /= static_cast<double>(drift.count);
  return drift;
}

}  // namespace

std::vector<PosePair> common_poses(const EstimatedRun& run, const Truth& truth) {
  std::vector<PosePair> poses;
  for (std::size_t i = 0; i < run.size() && i < truth.frames.size(); ++i) {
    if (!run[i].T_world_cam || !truth.frames[i].T_truth_cam) continue;
    poses.push_back({i, *run[i].T_world_cam, *truth.frames[i].T_truth_cam});
  }
  return poses;
}

std::optional<Rigid3> first_pose_alignment(const std::vector<PosePair>& poses) {
  if (poses.empty()) return std::nullopt;
  return poses.front().T_truth_cam * poses.front().T_world_cam.inverse();
}

std::optional<TrajectoryError> trajectory_error(const std::vector<PosePair>& poses) {
  if (poses.size() < 2) return std::nullopt;
  const std::vector<double> length_m = path_lengths(poses);
  std::vector<double> absolute_m, absolute_rad, step_m, step_rad;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Rigid3 since_start = relative_error(poses.front(), poses[i]);
    absolute_m.push_back(since_start.translation().norm());
    absolute_rad.push_back(rotation_angle_rad(since_start.linear()));
    if (poses[i].frame != poses[i - 1].frame + 1) continue;  // a step over a hole is not a step
    const Rigid3 step = relative_error(poses[i - 1], poses[i]);
    step_m.push_back(step.translation().norm());
    step_rad.push_back(rotation_angle_rad(step.linear()));
  }
  TrajectoryError error;
  error.poses = poses.size();
  error.path_length_m = length_m.back();
  error.ate_rmse_m = ate_rmse(poses);
  error.final_drift_m = absolute_m.back();
  error.final_drift_rad = absolute_rad.back();
  if (length_m.back() > kShortestPath_m) error.final_drift_percent = 100.0 * error.final_drift_m / length_m.back();
  error.absolute_m = summarize(std::move(absolute_m));
  error.absolute_rad = summarize(std::move(absolute_rad));
  error.step_m = summarize(std::move(step_m));
  error.step_rad = summarize(std::move(step_rad));
  error.kitti = sub_path_drift(poses, length_m);
  return error;
}

}  // namespace pelorus
