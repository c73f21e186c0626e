#pragma once
// The vehicle's own motion as its users want it: of the body (x forward, y starboard, z down), in the world as the body
// stood at the first accepted frame. The pipeline speaks of the left camera; this is the only place where the two meet.
// Covariances: of left perturbations (core/geometry/transform.h), carried over by the adjoint. Pure, no allocation.

#include "core/base/time.h"
#include "core/model/stage_data.h"

namespace pelorus {

// Camera quantities to body quantities. The world of the wire has its origin and axes in the body at the start:
// T_world_body = T_body_cam * T_cam0_cam * T_cam_body, with cam0 the pipeline's world.
class BodyFrames {
 public:
  explicit BodyFrames(const Rigid3& T_body_cam);

  [[nodiscard]] const Rigid3& T_body_cam() const { return T_body_cam_; }
  // A pose or motion given in the pipeline's world, in the world of the wire.
  [[nodiscard]] Rigid3 pose_of_body(const Rigid3& T_cam0_cam) const { return T_body_cam_ * T_cam0_cam * T_cam_body_; }
  [[nodiscard]] Rigid3 pose_of_object(const Rigid3& T_cam0_obj) const { return T_body_cam_ * T_cam0_obj; }
  [[nodiscard]] Rigid3 world_motion(const Rigid3& M_cam0) const { return T_body_cam_ * M_cam0 * T_cam_body_; }
  [[nodiscard]] Eigen::Vector3d point(const Eigen::Vector3d& p_cam0) const { return T_body_cam_ * p_cam0; }
  [[nodiscard]] Matrix6d covariance(const Matrix6d& cov_cam) const { return Ad_ * cov_cam * Ad_.transpose(); }

 private:
  Rigid3 T_body_cam_;
  Rigid3 T_cam_body_;
  Matrix6d Ad_;
};

// Velocity over the last step: (v, omega) [m/s, rad/s], body axes, of the body's origin.
struct BodyTwist {
  bool valid = false;
  Vector6d twist = Vector6d::Zero();
  Matrix6d cov_twist = Matrix6d::Zero();
};
[[nodiscard]] BodyTwist body_twist(const FrameResult& result, const BodyFrames& frames, Duration step);

// Motion of an object over the last step as a twist per second of its centroid: velocity [m/s] and turn rate [rad/s],
// axes of the world of the wire.
struct ObjectTwist {
  bool valid = false;
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_radps = Eigen::Vector3d::Zero();
};
[[nodiscard]] ObjectTwist object_twist(const ObjectState& object, const BodyFrames& frames, Duration step);

// 0..100; -1 when there is no estimate. Full marks need 150 static points and a clear choice of the world.
[[nodiscard]] int quality_percent(const FrameResult& result);

}  // namespace pelorus
