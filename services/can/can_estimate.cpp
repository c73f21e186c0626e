#include "services/can/can_estimate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pelorus {
namespace {

constexpr double kMm2PerM2 = 1e6;

// One standard deviation along the worst axis of a 3x3 covariance; unknown when it is none.
double worst_sigma(const Eigen::Matrix3d& cov) {
  if (!cov.allFinite()) return kUnknown;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(0.5 * (cov + cov.transpose()), Eigen::EigenvaluesOnly);
  const double largest = solver.eigenvalues().maxCoeff();
  return largest >= 0 ? std::sqrt(largest) : kUnknown;
}

// The motion of the vehicle from the frame before, in its own axes.
struct BodyStep {
  Rigid3 T_bodyprev_bodycurr = Rigid3::Identity();
  Matrix6d cov = Matrix6d::Zero();  // of the left perturbation of T_bodycurr_bodyprev
  double interval_s = 0;
};

bool step_known(const FrameResult& result, const PreviousResult& previous) {
  return result.pose_valid && previous.known && result.capture_time > previous.capture_time;
}

// Is `previous` the frame that T_curr_prev starts from?
bool adjoining(const FrameResult& result, const PreviousResult& previous) {
  const auto missed = static_cast<std::uint64_t>(std::max(0, result.report.frames_missed));
  return previous.seq + 1 + missed == result.seq;
}

bool find_step(const FrameResult& result, const PreviousResult& previous, const Rigid3& T_body_cam, BodyStep& step) {
  if (!step_known(result, previous)) return false;
  step.interval_s = seconds(result.capture_time - previous.capture_time);
  const Matrix6d Ad = adjoint(T_body_cam);
  step.cov = Ad * result.cov_T_curr_prev * Ad.transpose();
  Rigid3 T_camprev_camcurr = result.T_curr_prev.inverse();
  if (!adjoining(result, previous)) {
    // Results were skipped: only the poses span the gap, and only if nothing jumped between them.
    if (!previous.pose_valid || previous.reset_counter != result.reset_counter) return false;
    if (result.seq <= previous.seq) return false;
    T_camprev_camcurr = previous.T_world_cam.inverse() * result.T_world_cam;
    step.cov *= static_cast<double>(result.seq - previous.seq);
  }
  step.T_bodyprev_bodycurr = T_body_cam * T_camprev_camcurr * T_body_cam.inverse();
  return true;
}

void put_step(const BodyStep& step, CanEstimate& out) {
  const Rigid3 T_bodycurr_bodyprev = step.T_bodyprev_bodycurr.inverse();
  const Eigen::Vector3d t_curr = T_bodycurr_bodyprev.translation();  // origin at prev, seen now
  const Eigen::Matrix3d R_prev_curr = step.T_bodyprev_bodycurr.linear();
  const Eigen::Vector3d vel_mps = -t_curr / step.interval_s;
  out.vel_x_mps = vel_mps.x();
  out.vel_y_mps = vel_mps.y();
  out.vel_z_mps = vel_mps.z();
  const Eigen::Vector3d way = step.T_bodyprev_bodycurr.translation();
  out.step_x_m = way.x();
  out.step_y_m = way.y();
  out.step_z_m = way.z();
  const Eigen::Vector3d turn = so3_log(R_prev_curr);
  out.turn_x_rad = turn.x();
  out.turn_y_rad = turn.y();
  out.turn_z_rad = turn.z();
  out.interval_s = step.interval_s;
  // exp(xi) T_hat moves the translation by rho + phi x t: its covariance, in the axes of curr, then of prev.
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -skew(t_curr);
  const Eigen::Matrix3d cov_way_curr = J * step.cov * J.transpose();
  const Eigen::Matrix3d cov_way = R_prev_curr * cov_way_curr * R_prev_curr.transpose();
  const Eigen::Matrix3d cov_turn = R_prev_curr * step.cov.bottomRightCorner<3, 3>() * R_prev_curr.transpose();
  out.sigma_step_m = worst_sigma(cov_way);
  out.sigma_vel_mps = out.sigma_step_m / step.interval_s;
  out.step_var_x_mm2 = cov_way(0, 0) * kMm2PerM2;
  out.step_var_y_mm2 = cov_way(1, 1) * kMm2PerM2;
  out.step_var_z_mm2 = cov_way(2, 2) * kMm2PerM2;
  out.turn_var_x_mrad2 = cov_turn(0, 0) * kMm2PerM2;
  out.turn_var_y_mrad2 = cov_turn(1, 1) * kMm2PerM2;
  out.turn_var_z_mrad2 = cov_turn(2, 2) * kMm2PerM2;
}

// Euler angles exist here only, on the wire: R_start_body = Rz(yaw) Ry(pitch) Rx(roll).
void put_pose(const FrameResult& result, const Rigid3& T_body_cam, CanEstimate& out) {
  // `world` is the left camera at the first frame, `start` the body then: one mounting apart.
  const Rigid3 T_start_world = T_body_cam;
  const Rigid3 T_start_body = T_start_world * result.T_world_cam * T_body_cam.inverse();
  const Eigen::Matrix3d R = T_start_body.linear();
  out.roll_rad = std::atan2(R(2, 1), R(2, 2));
  out.pitch_rad = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  out.yaw_rad = std::atan2(R(1, 0), R(0, 0));
  const Eigen::Vector3d p = T_start_body.translation();
  out.position_x_m = p.x();
  out.position_y_m = p.y();
  out.position_z_m = p.z();
  const Matrix6d Ad = adjoint(T_start_world);
  const Matrix6d cov = Ad * result.cov_T_world_cam * Ad.transpose();
  out.sigma_att_rad = worst_sigma(cov.bottomRightCorner<3, 3>());
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -skew(p);
  out.sigma_position_m = worst_sigma(J * cov * J.transpose());
}

bool published(const ObjectState& object) {
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

void put_nearest_body(const FrameResult& result, const BodyStep* step, const Rigid3& T_body_cam, CanEstimate& out) {
  const Rigid3 T_body_world = T_body_cam * result.T_world_cam.inverse();
  const ObjectState* nearest = nullptr;
  Eigen::Vector3d p_body = Eigen::Vector3d::Zero();
  int bodies = 0;
  for (const ObjectState& object : result.objects_view()) {
    if (!published(object)) continue;
    ++bodies;
    const Eigen::Vector3d p = T_body_world * object.centroid_world;
    if (!p.allFinite() || (nearest != nullptr && p.norm() >= p_body.norm())) continue;
    nearest = &object;
    p_body = p;
  }
  out.bodies = bodies;
  if (nearest == nullptr) return;
  put_object(*nearest, p_body, out);
  if (step == nullptr) return;
  // M_world covers the same step as T_curr_prev; its centroid then, seen from the vehicle then.
  const Eigen::Vector3d p_prev_world = nearest->M_world.inverse() * nearest->centroid_world;
  const Eigen::Vector3d p_bodyprev = step->T_bodyprev_bodycurr * (T_body_world * p_prev_world);
  out.object_closing_mps = (p_bodyprev.norm() - p_body.norm()) / step->interval_s;
}

}  // namespace

PreviousResult remember(const FrameResult& result) {
  return {true, result.seq, result.capture_time, result.pose_valid, result.reset_counter, result.T_world_cam};
}

double quality_percent_of(const FrameResult& result) {
  if (!result.pose_valid) return 0;
  const double points = std::min(1.0, static_cast<double>(result.report.points_static) / kFullQualityPoints);
  const double margin = std::clamp(result.world_confidence / kFullQualityConfidence, 0.0, 1.0);
  const double most = result.state == VisionState::tracking ? 100 : 50;
  return std::clamp(std::round(100 * points * margin), 1.0, most);
}

CanEstimate estimate_of(const FrameResult& result, const PreviousResult& previous, const Rigid3& T_body_cam,
                        Timestamp now) {
  CanEstimate out;
  out.state = result.state;
  out.quality_percent = quality_percent_of(result);
  out.resets = result.reset_counter;
  if (result.capture_time.ns != 0 && now >= result.capture_time) out.age_s = seconds(now - result.capture_time);
  if (!result.pose_valid) return out;
  put_pose(result, T_body_cam, out);
  BodyStep step;
  const bool step_found = find_step(result, previous, T_body_cam, step);
  if (step_found) put_step(step, out);
  const bool same_step = step_found && adjoining(result, previous);
  put_nearest_body(result, same_step ? &step : nullptr, T_body_cam, out);
  return out;
}

}  // namespace pelorus
