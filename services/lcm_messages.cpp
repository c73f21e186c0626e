#include "services/lcm_messages.h"

#include <algorithm>
#include <limits>

namespace pelorus {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A transform that nothing is known of.
Rigid3 unknown_transform() {
  Rigid3 T;
  T.matrix().setConstant(kNaN);
  return T;
}

void put_point(const Eigen::Vector3d& p, double out[3]) { std::copy_n(p.data(), 3, out); }

void put_transform(const Rigid3& T, double pos_m[3], double quat_wxyz[4]) {
  put_point(T.translation(), pos_m);
  if (!T.matrix().allFinite()) {
    std::fill_n(quat_wxyz, 4, kNaN);
    return;
  }
  Eigen::Quaterniond q(T.linear());
  q.normalize();
  const double sign = q.w() < 0 ? -1 : 1;  // one of the two that mean the same
  quat_wxyz[0] = sign * q.w();
  quat_wxyz[1] = sign * q.x();
  quat_wxyz[2] = sign * q.y();
  quat_wxyz[3] = sign * q.z();
}

void put_covariance(const Matrix6d& cov, double out[36]) {
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) out[6 * row + column] = cov(row, column);
  }
}

Matrix6d unknown_covariance() { return Matrix6d::Constant(kNaN); }

vis_track_t track_message(const ObjectState& object, const Publication& publication, const BodyFrames& frames) {
  const FrameResult& result = publication.result;
  vis_track_t m{};
  m.id = object.id.value;
  m.phase = static_cast<std::int8_t>(object.phase);
  m.phase_text = to_text(object.phase);
  m.motion_measured = object.motion_measured;
  m.points = object.points;
  put_transform(frames.pose_of_object(object.T_world_obj), m.pos_m, m.quat_wxyz);
  put_covariance(frames.covariance(object.cov_T_world_obj), m.cov_pose);
  put_transform(frames.world_motion(object.M_world), m.step_pos_m, m.step_quat_wxyz);
  put_covariance(frames.covariance(object.cov_M_world), m.cov_step);
  const ObjectTwist twist = object_twist(object, frames, publication.step);
  m.velocity_valid = twist.valid;
  put_point(twist.valid ? twist.velocity_mps : Eigen::Vector3d::Constant(kNaN), m.vel_world_mps);
  put_point(twist.valid ? twist.rate_radps : Eigen::Vector3d::Constant(kNaN), m.rate_world_radps);
  put_point(frames.point(object.centroid_world), m.centroid_world_m);
  const Eigen::Vector3d p_cam = result.T_world_cam.inverse() * object.centroid_world;
  put_point(frames.T_body_cam() * p_cam, m.centroid_body_m);
  m.range_m = p_cam.norm();
  put_point(object.extent_m, m.extent_m);
  m.first_seen_utime = utime_of(object.first_seen);
  m.last_seen_utime = utime_of(object.last_seen);
  m.n_outline = object.outline_size;
  for (int i = 0; i < object.outline_size; ++i) {
    m.outline_u_px.push_back(object.outline[static_cast<std::size_t>(i)].u_px);
    m.outline_v_px.push_back(object.outline[static_cast<std::size_t>(i)].v_px);
  }
  return m;
}

}  // namespace

std::int64_t utime_of(Timestamp time) { return time.ns / 1000 - (time.ns % 1000 < 0 ? 1 : 0); }

vis_odom_t odom_message(const Publication& publication, const BodyFrames& frames) {
  const FrameResult& result = publication.result;
  vis_odom_t m{};
  m.utime = utime_of(result.capture_time);
  m.publish_utime = utime_of(publication.released);
  m.latency_ms = 1e3 * seconds(publication.released - result.capture_time);
  m.deadline_missed = publication.deadline_missed;
  m.seq = static_cast<std::int64_t>(result.seq);
  m.state = static_cast<std::int8_t>(result.state);
  m.state_text = to_text(result.state);
  m.reason_text = to_text(publication.reason);
  m.pose_valid = result.pose_valid;
  m.quality_percent = static_cast<std::int8_t>(quality_percent(result));
  m.reset_counter = result.reset_counter;
  m.world_confidence = result.world_confidence;
  m.points_static = result.report.points_static;
  m.points_moving = result.report.points_moving;
  const bool valid = result.pose_valid;
  put_transform(valid ? frames.pose_of_body(result.T_world_cam) : unknown_transform(), m.pos_m, m.quat_wxyz);
  put_covariance(valid ? frames.covariance(result.cov_T_world_cam) : unknown_covariance(), m.cov_pose);

  const BodyTwist twist = body_twist(result, frames, publication.step);
  const Eigen::Vector3d unknown = Eigen::Vector3d::Constant(kNaN);
  m.velocity_valid = twist.valid;
  put_point(twist.valid ? Eigen::Vector3d(twist.twist.head<3>()) : unknown, m.vel_body_mps);
  put_point(twist.valid ? Eigen::Vector3d(twist.twist.tail<3>()) : unknown, m.rate_body_radps);
  put_covariance(twist.valid ? twist.cov_twist : unknown_covariance(), m.cov_velocity);

  m.step_s = twist.valid ? seconds(publication.step) : 0.0;
  const Rigid3 T_prev_curr = result.T_curr_prev.inverse();
  put_transform(twist.valid ? frames.pose_of_body(T_prev_curr) : unknown_transform(), m.step_pos_m, m.step_quat_wxyz);
  put_covariance(twist.valid ? Matrix6d(twist.cov_twist * (m.step_s * m.step_s)) : unknown_covariance(), m.cov_step);
  return m;
}

vis_tracks_t tracks_message(const Publication& publication, const BodyFrames& frames) {
  const FrameResult& result = publication.result;
  vis_tracks_t m{};
  m.utime = utime_of(result.capture_time);
  m.publish_utime = utime_of(publication.released);
  m.seq = static_cast<std::int64_t>(result.seq);
  m.state = static_cast<std::int8_t>(result.state);
  m.state_text = to_text(result.state);
  m.step_s = result.pose_valid ? seconds(publication.step) : 0.0;
  if (result.pose_valid) {
    for (const ObjectState& object : result.objects_view()) {
      m.tracks.push_back(track_message(object, publication, frames));
      m.n_confirmed += object.phase == ObjectPhase::confirmed ? 1 : 0;
    }
  }
  m.n_tracks = static_cast<std::int32_t>(m.tracks.size());
  return m;
}

std::optional<bot_core::pose_t> pose_message(const Publication& publication, const BodyFrames& frames) {
  const BodyTwist twist = body_twist(publication.result, frames, publication.step);
  if (!twist.valid) return std::nullopt;
  bot_core::pose_t m{};
  m.utime = utime_of(publication.result.capture_time);
  put_transform(frames.pose_of_body(publication.result.T_world_cam), m.pos, m.orientation);
  put_point(twist.twist.head<3>(), m.vel);
  put_point(twist.twist.tail<3>(), m.rotation_rate);
  return m;
}

namespace {

std::int64_t count(std::uint64_t events) { return static_cast<std::int64_t>(events); }

void put_timing(const TimingReport& timing, vis_health_t& m) {
  m.pairs_rate_hz = timing.pairs_rate_hz;
  m.results_rate_hz = timing.results_rate_hz;
  m.interval_max_ms = timing.interval_max_ms;
  m.interval_jitter_ms = timing.interval_jitter_ms;
  m.latency_p50_ms = timing.latency_p50_ms;
  m.latency_p99_ms = timing.latency_p99_ms;
  m.latency_max_ms = timing.latency_max_ms;
  m.release_jitter_ms = timing.release_jitter_ms;
  m.step_p50_ms = timing.step_p50_ms;
  m.step_max_ms = timing.step_max_ms;
}

void put_counters(const CounterReport& c, vis_health_t& m) {
  m.pairs_captured = count(c.pairs_captured);
  m.results_published = count(c.results_published);
  m.deadline_misses = count(c.deadline_misses);
  m.dropped_in_source = count(c.dropped_in_source);
  m.dropped_ring_full = count(c.dropped_ring_full);
  m.dropped_superseded = count(c.dropped_superseded);
  m.dropped_unpaired = count(c.dropped_unpaired);
  m.results_dropped = count(c.results_dropped);
  m.camera_timeouts = count(c.camera_timeouts);
  m.frozen_spells = count(c.frozen_spells);
  m.steps_shed = count(c.steps_shed);
  m.time_jumps = count(c.time_jumps);
  m.losses_of_track = count(c.losses_of_track);
  m.lcm_errors = count(c.lcm_errors);
  m.lcm_reconnects = count(c.lcm_reconnects);
  m.previews_skipped = count(c.previews_skipped);
  m.pictures_incomplete = count(c.pictures_incomplete);
  m.packets_missing = count(c.packets_missing);
  m.packets_resent = count(c.packets_resent);
  m.camera_reopens = count(c.camera_reopens);
  m.can_sets_sent = count(c.can_sets_sent);
  m.can_sets_dropped = count(c.can_sets_dropped);
  m.can_sets_unheard = count(c.can_sets_unheard);
  m.can_error_frames = count(c.can_error_frames);
  m.can_bus_offs = count(c.can_bus_offs);
  m.recorder_pairs_written = count(c.recorder_pairs_written);
  m.recorder_pairs_dropped = count(c.recorder_pairs_dropped);
  m.recorder_pairs_failed = count(c.recorder_pairs_failed);
}

}  // namespace

vis_health_t health_message(const HealthReport& report) {
  vis_health_t m{};
  m.utime = utime_of(report.time);
  m.seq = count(report.seq);
  m.uptime_s = report.uptime_s;
  m.state = static_cast<std::int8_t>(report.state);
  m.state_text = to_text(report.state);
  m.reason_text = to_text(report.reason);
  m.version = report.version;
  put_timing(report.timing, m);
  put_counters(report.counters, m);
  m.sync_error_ms = report.picture.sync_error_ms;
  m.exposure_ms = report.picture.exposure_ms;
  m.mean_grey = report.picture.mean_grey;
  m.contrast_grey = report.picture.contrast_grey;
  m.sigma_px = report.picture.sigma_px;
  m.cpu_percent = report.host.cpu_percent;
  m.memory_mb = report.host.memory_mb;
  m.temperature_degc = report.host.temperature_degc;
  m.disk_free_gb = report.host.disk_free_gb;
  m.wall_step_s = report.wall_step_s;
  m.recorder_text = report.recorder_text;
  m.can_text = report.can_text;
  m.privileges_text = report.privileges_text;
  m.config_hash = report.config_hash;
  m.calibration_hash = report.calibration_hash;
  return m;
}

}  // namespace pelorus
