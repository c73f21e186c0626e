#include "services/body_estimate.h"

#include <algorithm>
#include <cmath>

namespace pelorus {

BodyFrames::BodyFrames(const Rigid3& T_body_cam)
    : T_body_cam_(T_body_cam), T_cam_body_(T_body_cam.inverse()), Ad_(adjoint(T_body_cam)) {}

// T_prev_curr of the body is exp(twist * step); the pipeline gives H = T_curr_prev of the camera. A left perturbation
// xi of H is -Ad(H^-1) xi on the left of its inverse, and Ad(T_body_cam) carries it to the body.
BodyTwist body_twist(const FrameResult& result, const BodyFrames& frames, Duration step) {
  BodyTwist out;
  const double dt_s = seconds(step);
  if (!result.pose_valid || dt_s <= 0) return out;
  const Rigid3 T_prev_curr = result.T_curr_prev.inverse();
  const Matrix6d Ad = adjoint(T_prev_curr);
  out.valid = true;
  out.twist = se3_log(frames.pose_of_body(T_prev_curr)) / dt_s;
  out.cov_twist = frames.covariance(Ad * result.cov_T_curr_prev * Ad.transpose()) / (dt_s * dt_s);
  return out;
}

ObjectTwist object_twist(const ObjectState& object, const BodyFrames& frames, Duration step) {
  ObjectTwist out;
  const double dt_s = seconds(step);
  if (dt_s <= 0) return out;
  const Eigen::Vector3d centroid_world = frames.point(object.centroid_world);
  const Rigid3 M_world = frames.world_motion(object.M_world);
  out.valid = true;
  out.velocity_mps = (centroid_world - M_world.inverse() * centroid_world) / dt_s;
  out.rate_radps = so3_log(M_world.linear()) / dt_s;
  return out;
}

int quality_percent(const FrameResult& result) {
  constexpr double kManyPoints = 150;
  constexpr double kClearChoice = 0.3;  // of world_confidence
  if (!result.pose_valid) return -1;
  const double points = std::min(1.0, result.report.points_static / kManyPoints);
  const double choice = std::clamp(result.world_confidence / kClearChoice, 0.0, 1.0);
  return static_cast<int>(std::lround(100 * points * choice));
}

}  // namespace pelorus
