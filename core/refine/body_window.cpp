#include "core/refine/body_window.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/geometry/robust_weight.h"

namespace pelorus {
namespace {

constexpr std::size_t kPointsPerChosen = 5;  // points remembered for each that is adjusted

// Where the six unknowns of a frame begin.
Eigen::Index row_of(int unknown) { return 6 * static_cast<Eigen::Index>(unknown); }

}  // namespace

BodyWindow::BodyWindow(const BodyWindowConfig& config) : config_(config) {
  frames_.reserve(kMaxWindowFrames);
  points_.reserve(kPointsPerChosen * static_cast<std::size_t>(config.max_points));
  blocks_.resize(static_cast<std::size_t>(config.max_points));
  clear();
}

void BodyWindow::clear() {
  frames_.clear();
  points_.clear();
  free_slots_ = (1u << kMaxWindowFrames) - 1u;
  next_number_ = 0;
  sigma_scale_ = 1.0;
  cov_T_cam_body_.setZero();
  cov_H_.setZero();
}

const BodyPoint* BodyWindow::find(TrackId track) const {
  const auto place = std::lower_bound(points_.begin(), points_.end(), track,
                                      [](const BodyPoint& p, TrackId t) { return p.track < t; });
  return place != points_.end() && place->track == track ? &*place : nullptr;
}

void BodyWindow::remove(TrackId track) {
  if (const BodyPoint* point = find(track)) points_.erase(points_.begin() + (point - points_.data()));
}

void BodyWindow::change_frame(const Rigid3& T_new_old) {
  const Rigid3 T_old_new = T_new_old.inverse();
  for (Frame& frame : frames_) frame.T_cam_body = orthonormalized(frame.T_cam_body * T_old_new);
  for (BodyPoint& point : points_) point.p_body = T_new_old * point.p_body;
}

// Until there are key frames the oldest frame is held; afterwards their inertia fixes the gauge.
int BodyWindow::number_unknowns() {
  const bool has_keys = frames_.size() > static_cast<std::size_t>(config_.recent_frames);
  int count = 0;
  for (std::size_t f = 0; f < frames_.size(); ++f) frames_[f].unknown = f == 0 && !has_keys ? -1 : count++;
  return count;
}

// Key frames resist by a multiple of their own information. Held fast they would keep the scale of the motion as it
// was when they left the recent part, although all stereo pairs together tell it better; free they would let the
// whole window slip on its oldest points. Residuals have no component along the gauge, so inertia adds no drift.
void BodyWindow::add_inertia() {
  if (frames_.size() <= static_cast<std::size_t>(config_.recent_frames)) return;
  const std::size_t keys = frames_.size() - static_cast<std::size_t>(config_.recent_frames);
  for (std::size_t f = 0; f < keys; ++f) {
    const Eigen::Index row = row_of(frames_[f].unknown);
    reduced_.S.block<6, 6>(row, row) += config_.key_frame_inertia * own_information_[f];
  }
}

double BodyWindow::accumulate_points(const StereoRig& rig) {
  double weighted_chi2 = 0;
  double dof = 0;
  own_information_.fill(Matrix6d::Zero());
  for (PointBlock& block : blocks_) {
    if (block.point < 0) break;
    const BodyPoint& point = points_[static_cast<std::size_t>(block.point)];
    const double inverse_variance = 1.0 / (point.sigma_px * point.sigma_px);
    Eigen::Matrix3d V = Eigen::Matrix3d::Zero();
    block.b.setZero();
    block.terms = 0;
    std::array<Eigen::Index, kMaxWindowFrames> row{};
    double weight_sum = 0;
    int count = 0;
    for (const Frame& frame : frames_) {
      if ((point.seen & (1u << frame.slot)) == 0u) continue;
      const Eigen::Vector3d p_cam = frame.T_cam_body * point.p_body;
      if (!(p_cam.z() > 1e-3)) continue;
      const Eigen::Vector3d r = point.z_px[static_cast<std::size_t>(frame.slot)] - rig.project(p_cam);
      const double chi2 = r.squaredNorm() * inverse_variance;
      const double w = frame.weight * geman_mcclure_weight(frame.weight * chi2, config_.robust_chi2);
      weighted_chi2 += w * chi2;
      weight_sum += w;
      ++count;
      const Eigen::Matrix3d J = rig.project_jacobian(p_cam);
      const Eigen::Matrix3d A = J * frame.T_cam_body.linear();
      const double w_px = w * inverse_variance;
      V += w_px * A.transpose() * A;
      block.b += w_px * A.transpose() * r;
      if (frame.unknown < 0) continue;
      Eigen::Matrix<double, 3, 6> B;
      B.leftCols<3>() = J;
      B.rightCols<3>() = -J * skew(p_cam);
      const auto t = static_cast<std::size_t>(block.terms++);
      block.unknown[t] = frame.unknown;
      block.W[t] = w_px * B.transpose() * A;
      row[t] = row_of(frame.unknown);
      const Matrix6d own = w_px * B.transpose() * B;
      own_information_[static_cast<std::size_t>(&frame - frames_.data())] += own;
      reduced_.S.block<6, 6>(row[t], row[t]) += own;
      reduced_.g.segment<6>(row[t]) += w_px * B.transpose() * r;
    }
    // Each point's own three unknowns take their share of its measurements, whatever these weigh.
    if (count > 1) dof += 3.0 * weight_sum * (count - 1) / count;
    V.diagonal().array() += 1e-9;
    block.V_inv = V.inverse();
    for (std::size_t i = 0; i < static_cast<std::size_t>(block.terms); ++i) {
      const Eigen::Matrix<double, 6, 3> WV = block.W[i] * block.V_inv;
      reduced_.g.segment<6>(row[i]) -= WV * block.b;
      // Lower triangle only; frames come oldest first, so row[i] >= row[j] for j <= i.
      for (std::size_t j = 0; j <= i; ++j) {
        reduced_.S.block<6, 6>(row[i], row[j]) -= WV * block.W[j].transpose();
      }
    }
  }
  dof -= static_cast<double>(reduced_.g.size());
  return dof > 0 ? std::sqrt(weighted_chi2 / dof) : 1.0;
}

// Constant velocity in the body's own frame: log(T_a^-1 T_b)/dt changes between steps by white noise.
void BodyWindow::accumulate_prior() {
  for (std::size_t c = 2; c < frames_.size(); ++c) {
    const Frame* frame[3] = {&frames_[c - 2], &frames_[c - 1], &frames_[c]};
    const double dt_ab = seconds(frame[1]->time - frame[0]->time);
    const double dt_bc = seconds(frame[2]->time - frame[1]->time);
    if (!(dt_ab > 0) || !(dt_bc > 0)) continue;
    Rigid3 T_world_obj[3];
    for (int k = 0; k < 3; ++k) T_world_obj[k] = frame[k]->T_world_cam * frame[k]->T_cam_body;
    const Vector6d r = -(se3_log(T_world_obj[1].inverse() * T_world_obj[2]) / dt_bc -
                         se3_log(T_world_obj[0].inverse() * T_world_obj[1]) / dt_ab);
    const double dt = 0.5 * (dt_ab + dt_bc);
    Vector6d weight;
    weight.head<3>().setConstant(1.0 / (config_.sigma_acceleration_mps2 * config_.sigma_acceleration_mps2 * dt));
    weight.tail<3>().setConstant(1.0 / (config_.sigma_acceleration_radps2 * config_.sigma_acceleration_radps2 * dt));
    // Left Jacobians of the logarithm are taken as the identity: steps are small.
    const Matrix6d J[3] = {adjoint(T_world_obj[0].inverse() * frame[0]->T_world_cam) / dt_ab,
                           -adjoint(T_world_obj[1].inverse() * frame[1]->T_world_cam) / dt_bc -
                               adjoint(T_world_obj[0].inverse() * frame[1]->T_world_cam) / dt_ab,
                           adjoint(T_world_obj[1].inverse() * frame[2]->T_world_cam) / dt_bc};
    for (int i = 0; i < 3; ++i) {
      if (frame[i]->unknown < 0) continue;
      reduced_.g.segment<6>(row_of(frame[i]->unknown)) += J[i].transpose() * weight.cwiseProduct(r);
      for (int j = 0; j <= i; ++j) {
        if (frame[j]->unknown < 0) continue;
        reduced_.S.block<6, 6>(row_of(frame[i]->unknown), row_of(frame[j]->unknown)) +=
            J[i].transpose() * weight.asDiagonal() * J[j];
      }
    }
  }
}

void BodyWindow::apply_update(const Unknowns& xi) {
  for (PointBlock& block : blocks_) {
    if (block.point < 0) break;
    Eigen::Vector3d b = block.b;
    for (std::size_t t = 0; t < static_cast<std::size_t>(block.terms); ++t) {
      b -= block.W[t].transpose() * xi.segment<6>(row_of(block.unknown[t]));
    }
    points_[static_cast<std::size_t>(block.point)].p_body += block.V_inv * b;
  }
  for (Frame& frame : frames_) {
    if (frame.unknown < 0) continue;
    frame.T_cam_body = orthonormalized(se3_exp(xi.segment<6>(row_of(frame.unknown))) * frame.T_cam_body);
  }
}

StageOutcome BodyWindow::adjust(const StereoRig& rig) {
  const auto shared = std::count_if(points_.begin(), points_.end(), [&](const BodyPoint& p) {
    return (p.seen & newest_bit()) != 0u && __builtin_popcount(p.seen) >= 2;
  });
  if (frames_.size() < 2 || shared < 3) return StageOutcome::too_few_points;
  const Eigen::Index unknowns = row_of(number_unknowns());
  choose_points();
  weigh_frames();
  StageOutcome outcome = StageOutcome::ok;
  for (int iteration = 0; iteration < config_.iterations; ++iteration) {
    reduced_.S.setZero(unknowns, unknowns);
    reduced_.g.setZero(unknowns);
    sigma_scale_ = accumulate_points(rig);
    add_inertia();
    if (config_.acceleration_prior) accumulate_prior();
    reduced_.S.diagonal().array() += 1e-6;  // a frame without points must not break the others
    const Eigen::LLT<Information, Eigen::Lower> solver(reduced_.S);
    if (solver.info() != Eigen::Success) return StageOutcome::degenerate;
    const Unknowns xi = solver.solve(reduced_.g);
    if (!xi.allFinite() || xi.cwiseAbs().maxCoeff() > 1.0) return StageOutcome::degenerate;
    apply_update(xi);
    if (iteration + 1 == config_.iterations) measure_covariance();
  }
  judge_points(rig);
  return outcome;
}

void BodyWindow::measure_covariance() {
  const Eigen::LLT<Information, Eigen::Lower> solver(reduced_.S);
  const auto size = reduced_.S.rows();
  const int last = frames_.back().unknown;
  const int before = frames_[frames_.size() - 2].unknown;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, 12, 0, kMaxWindowUnknowns, 12>;
  Columns columns = Columns::Zero(size, 12);
  columns.block<6, 6>(row_of(last), 0).setIdentity();
  if (before >= 0) columns.block<6, 6>(row_of(before), 6).setIdentity();
  const Columns cov = solver.solve(columns);
  const double scale = std::max(0.01, sigma_scale_ * sigma_scale_);
  cov_T_cam_body_ = scale * cov.block<6, 6>(row_of(last), 0);
  cov_H_ = cov_T_cam_body_;
  if (before >= 0) {
    const Matrix6d Ad = adjoint(T_cam_body() * T_cam_body_previous().inverse());
    const Matrix6d cross = scale * cov.block<6, 6>(row_of(last), 6);
    const Matrix6d previous = scale * cov.block<6, 6>(row_of(before), 6);
    cov_H_ += Ad * previous * Ad.transpose() - cross * Ad.transpose() - Ad * cross.transpose();
  }
}

void BodyWindow::judge_points(const StereoRig& rig) {
  for (BodyPoint& point : points_) {
    double sum = 0;
    int count = 0;
    for (const Frame& frame : frames_) {
      if ((point.seen & (1u << frame.slot)) == 0u) continue;
      const Eigen::Vector3d p_cam = frame.T_cam_body * point.p_body;
      const Eigen::Vector3d r = point.z_px[static_cast<std::size_t>(frame.slot)] - rig.project(p_cam);
      sum += p_cam.z() > 1e-3 ? r.squaredNorm() / (point.sigma_px * point.sigma_px) : 1e6;
      ++count;
    }
    point.observations = count;
    point.chi2_mean = count > 0 ? sum / count : 0;
  }
}

}  // namespace pelorus
