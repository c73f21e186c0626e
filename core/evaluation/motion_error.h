#pragma once
// Errors of object motion, expressed in the TRUE object's frame at its centre, since any other origin turns rotation
// error into translation error (ME: Morris, Wang, Ila 2025). For the step from prev to curr:
//   E = (T_body_world M_true T_world_body)^-1 (T_body_world M_world T_world_body),  T_world_body at prev.
// Position since birth: the same with the motions accumulated since the estimate's first frame. Truth is brought
// into the estimate's world by the first common pose, so the camera's own drift is part of these errors. Pure.

#include <optional>
#include <vector>

#include "core/evaluation/association.h"
#include "core/evaluation/error_statistics.h"
#include "core/evaluation/records.h"

namespace pelorus {

struct MotionError {
  ErrorStatistics step_m;  // ME over confirmed, matched frames
  ErrorStatistics step_rad;
  ErrorStatistics since_birth_m;
  ErrorStatistics since_birth_rad;
};

// A body's pose in the estimate's world; absent where the truth lacks it.
[[nodiscard]] std::optional<Rigid3> true_body_in_world(const TrueFrame& frame, int body, const Rigid3& T_truth_world);

// Error of an estimated motion of a body that stood at T_world_body, in the body's frame.
[[nodiscard]] Rigid3 error_in_body_frame(const Rigid3& M_true, const Rigid3& M_world, const Rigid3& T_world_body);

[[nodiscard]] MotionError motion_error(const EstimatedRun& run, const Truth& truth,
                                       const std::vector<FrameMatches>& matches, int body, const Rigid3& T_truth_world);

}  // namespace pelorus
