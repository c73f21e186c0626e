#pragma once
// Errors of the camera trajectory against truth. Both are given in frames of their own; only poses known on both
// sides count. Metrics as their authors define them:
// - ATE: translation RMSE after rigid alignment (Umeyama 1991, no scale; Sturm et al. 2012).
// - absolute error: the same without alignment other than identifying the first common pose; its last value is the
//   final drift.
// - RPE / step error: relative motion of consecutive frames, E = (true step)^-1 * (estimated step).
// - KITTI drift: relative error of sub-paths of 100..800 m divided by their length (Geiger et al. 2012); for any
//   path, final drift over its whole length.
// Pure; O(n log n) but for the sub-paths, O(n).

#include <optional>
#include <vector>

#include "core/evaluation/error_statistics.h"
#include "core/evaluation/records.h"

namespace pelorus {

struct PosePair {
  std::size_t frame = 0;  // index in the run: neighbours in time are neighbours in number
  Rigid3 T_world_cam = Rigid3::Identity();
  Rigid3 T_truth_cam = Rigid3::Identity();
};

struct SubPathDrift {
  std::size_t count = 0;
  double translation_percent = 0;
  double rotation_deg_per_100m = 0;
};

struct TrajectoryError {
  std::size_t poses = 0;       // compared
  double path_length_m = 0;    // true
  double ate_rmse_m = 0;       // aligned
  ErrorStatistics absolute_m;  // first pose identified; the first pose itself (zero by definition) left out
  ErrorStatistics absolute_rad;
  ErrorStatistics step_m;  // RPE over consecutive frames
  ErrorStatistics step_rad;
  double final_drift_m = 0;
  double final_drift_rad = 0;
  std::optional<double> final_drift_percent;  // of the path's length; absent for a path too short to divide by
  std::optional<SubPathDrift> kitti;          // when a sub-path of 100 m exists
};

// Poses known on both sides, in order.
[[nodiscard]] std::vector<PosePair> common_poses(const EstimatedRun& run, const Truth& truth);

// T_truth_world that makes the first common pose agree; absent without a common pose.
[[nodiscard]] std::optional<Rigid3> first_pose_alignment(const std::vector<PosePair>& poses);

// Absent with fewer than two common poses.
[[nodiscard]] std::optional<TrajectoryError> trajectory_error(const std::vector<PosePair>& poses);

}  // namespace pelorus
