#include "services/can/can_estimate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pelorus {
namespace {

constexpr double kMm2PerM2 = 1e6;

// One standard deviation along the worst axis of a 3x3 covariance; unknown when it is none.
double worst_sigma(const Eigen::Matrix3d& cov) {
  if (!cov.allFinite()) return kCanUnknown;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(0.5 * (cov + cov.transpose()), Eigen::EigenvaluesOnly);
  const double largest = solver.eigenvalues().maxCoeff();
  return largest >= 0 ? std::sqrt(largest) : kCanUnknown;
}

// exp(xi) T_hat moves the translation t by rho + phi x t.
Eigen::Matrix3d translation_covariance(const Matrix6d& cov, const Eigen::Vector3d& t) {
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -skew(t);
  return J * cov * J.transpose();
}

// The motion of the vehicle between two measurements, in its own axes.
struct BodyStep {
  Rigid3 T_prev_curr = Rigid3::Identity();
  Matrix6d cov = Matrix6d::Zero();  // of its left perturbation, axes of prev
  double interval_s = 0;
};

// The step of the pipeline, from the frame before.
BodyStep frame_step(const FrameResult& result, const BodyFrames& frames, Duration step) {
  const Rigid3 T_camprev_camcurr = result.T_curr_prev.inverse();
  const Matrix6d Ad = adjoint(T_camprev_camcurr);  // xi on the left of H is -Ad(H^-1) xi on the left of its inverse
  BodyStep out;
  out.T_prev_curr = frames.pose_of_body(T_camprev_camcurr);
  out.cov = frames.covariance(Ad * result.cov_T_curr_prev * Ad.transpose());
  out.interval_s = seconds(step);
  return out;
}

// The step since the estimate that was sent before; the same, unless results in between were never sent.
BodyStep sent_step(const Publication& publication, const PreviousPose& previous, const BodyFrames& frames) {
  const FrameResult& result = publication.result;
  BodyStep step = frame_step(result, frames, publication.step);
  const Duration since = result.capture_time - previous.capture_time;
  const bool comparable = previous.known && previous.reset_counter == result.reset_counter;
  if (!comparable || since <= publication.step) return step;
  step.T_prev_curr = frames.pose_of_body(previous.T_world_cam.inverse() * result.T_world_cam);
  step.interval_s = seconds(since);
  step.cov *= step.interval_s / seconds(publication.step);
  return step;
}

void put_velocity(const BodyTwist& motion, CanEstimate& out) {
  out.vel_x_mps = motion.twist[0];
  out.vel_y_mps = motion.twist[1];
  out.vel_z_mps = motion.twist[2];
  out.sigma_vel_mps = worst_sigma(motion.cov_twist.topLeftCorner<3, 3>());
}

void put_step(const BodyStep& step, CanEstimate& out) {
  const Eigen::Vector3d way = step.T_prev_curr.translation();
  const Eigen::Vector3d turn = so3_log(step.T_prev_curr.linear());
  out.step_x_m = way.x();
  out.step_y_m = way.y();
  out.step_z_m = way.z();
  out.turn_x_rad = turn.x();
  out.turn_y_rad = turn.y();
  out.turn_z_rad = turn.z();
  out.interval_s = step.interval_s;
  const Eigen::Matrix3d cov_way = translation_covariance(step.cov, way);
  const Eigen::Matrix3d cov_turn = step.cov.bottomRightCorner<3, 3>();
  out.sigma_step_m = worst_sigma(cov_way);
  out.step_var_x_mm2 = cov_way(0, 0) * kMm2PerM2;
  out.step_var_y_mm2 = cov_way(1, 1) * kMm2PerM2;
  out.step_var_z_mm2 = cov_way(2, 2) * kMm2PerM2;
  out.turn_var_x_mrad2 = cov_turn(0, 0) * kMm2PerM2;
  out.turn_var_y_mrad2 = cov_turn(1, 1) * kMm2PerM2;
  out.turn_var_z_mrad2 = cov_turn(2, 2) * kMm2PerM2;
}

// Euler angles exist here only, on the wire: R_start_body = Rz(yaw) Ry(pitch) Rx(roll).
void put_pose(const FrameResult& result, const BodyFrames& frames, CanEstimate& out) {
  const Rigid3 T_start_body = frames.pose_of_body(result.T_world_cam);
  const Eigen::Matrix3d R = T_start_body.linear();
  out.roll_rad = std::atan2(R(2, 1), R(2, 2));
  out.pitch_rad = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  out.yaw_rad = std::atan2(R(1, 0), R(0, 0));
  const Eigen::Vector3d p = T_start_body.translation();
  out.position_x_m = p.x();
  out.position_y_m = p.y();
  out.position_z_m = p.z();
  const Matrix6d cov = frames.covariance(result.cov_T_world_cam);
  out.sigma_att_rad = worst_sigma(cov.bottomRightCorner<3, 3>());
  out.sigma_position_m = worst_sigma(translation_covariance(cov, p));
}

bool is_sent(const ObjectState& object) {
  return object.phase == ObjectPhase::confirmed || object.phase == ObjectPhase::coasting;
}

void put_object(const ObjectState& object, const Eigen::Vector3d& p_body, CanEstimate& out) {
  out.object_range_m = p_body.norm();
  out.object_bearing_rad = std::atan2(p_body.y(), p_body.x());
  out.object_elevation_rad = std::atan2(-p_body.z(), std::hypot(p_body.x(), p_body.y()));
  out.object_id = object.id.value % 255;
  out.object_points = object.points;
  out.object_phase = object.phase == ObjectPhase::confirmed ? 1 : 2;
  const double points = std::max(0, object.points);
  out.object_confidence_percent = (object.motion_measured ? 100.0 : 50.0) * points / (points + 10.0);
}

void put_nearest_body(const Publication& publication, const BodyFrames& frames, CanEstimate& out) {
  const FrameResult& result = publication.result;
  const Rigid3 T_body_world = frames.T_body_cam() * result.T_world_cam.inverse();
  const ObjectState* nearest = nullptr;
  Eigen::Vector3d p_body = Eigen::Vector3d::Zero();
  int bodies = 0;
  for (const ObjectState& object : result.objects_view()) {
    if (!is_sent(object)) continue;
    ++bodies;
    const Eigen::Vector3d p = T_body_world * object.centroid_world;
    if (!p.allFinite() || (nearest != nullptr && p.norm() >= p_body.norm())) continue;
    nearest = &object;
    p_body = p;
  }
  out.bodies = bodies;
  if (nearest == nullptr) return;
  put_object(*nearest, p_body, out);
  if (publication.step <= Duration::zero()) return;
  // M_world covers the same step as T_curr_prev; its centroid then, seen from the vehicle then.
  const BodyStep step = frame_step(result, frames, publication.step);
  const Eigen::Vector3d p_prev_world = nearest->M_world.inverse() * nearest->centroid_world;
  const Eigen::Vector3d p_bodyprev = step.T_prev_curr * (T_body_world * p_prev_world);
  out.object_closing_mps = (p_bodyprev.norm() - p_body.norm()) / step.interval_s;
}

}  // namespace

CanEstimate estimate_of(const Publication& publication, const PreviousPose& previous, const BodyFrames& frames,
                        Timestamp now) {
  const FrameResult& result = publication.result;
  CanEstimate out;
  out.state = result.state;
  out.quality_percent = result.pose_valid ? std::max(1, quality_percent(result)) : 0;
  out.resets = result.reset_counter;
  if (result.capture_time.ns != 0 && now >= result.capture_time) out.age_s = seconds(now - result.capture_time);
  if (!result.pose_valid) return out;
  put_pose(result, frames, out);
  put_nearest_body(publication, frames, out);
  const BodyTwist motion = body_twist(result, frames, publication.step);
  if (!motion.valid) return out;
  put_velocity(motion, out);
  put_step(sent_step(publication, previous, frames), out);
  return out;
}

}  // namespace pelorus
