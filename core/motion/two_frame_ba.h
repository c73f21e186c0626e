#pragma once
// Two-frame stereo bundle adjustment (method section 6): the motion of one rigid group and its points, points
// eliminated by Schur complement. Minimises the pixel errors of all four images, so depth noise is weighted as it
// is, which 3D-3D alignment cannot do. Replaces the paper's ICP on matched clouds (eq. 1).
// Scratch reserved at construction, no allocation in run(). Thread-bound. O(points * iterations).

#include <vector>

#include "core/geometry/rigid_fit.h"
#include "core/model/stage_data.h"

namespace pelorus {

struct TwoFrameBaConfig {
  int max_iterations = 12;
  // Geman-McClure scale on a point's squared error in deviations (3 degrees of freedom): beyond it a point counts
  // less and less, at a hundred times it not at all.
  double robust_chi2 = 20.0;
  double converged_update = 1e-8;  // norm of the twist update [m, rad]
  int max_points = 1000;           // evenly strided subset above it: bounds the cost per frame
  // Off, for ablation: the paper's alignment of the two clouds (1) of the points that the adjustment finds to agree.
  bool adjust = true;
};

struct MotionFit {
  StageOutcome outcome = StageOutcome::not_run;
  Rigid3 H_curr_prev = Rigid3::Identity();
  Matrix6d cov_H = Matrix6d::Zero();  // scaled by the residuals
  double rms_px = 0;                  // robust, per coordinate of noise: estimates sigma_px
  int support = 0;                    // members within the 99.9 % gate
};

class TwoFrameBa {
 public:
  TwoFrameBa(const TwoFrameBaConfig& config, int capacity);
  // Motion of `members` of `pairs`, from a start within the robust kernel's reach.
  // Outcomes: ok, too_few_points (< 3), degenerate (information matrix not invertible), not_converged (usable).
  [[nodiscard]] MotionFit run(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> members,
                              const Rigid3& H_start);

 private:
  void align(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> members, MotionFit& fit);

  TwoFrameBaConfig config_;
  std::vector<PointIndex> used_;
  std::vector<PointMatch> matches_;        // of the alignment
  std::vector<Eigen::Vector3d> z_hat_px_;  // corrected prev measurement of each used point: its structure
};

}  // namespace pelorus
