#include "firmware-host/pelorus/top/bus_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pelorus {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector3d vector_of(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

Eigen::Matrix3d R_world_body_of(const vis_odom_t& odom) {
  const double(&q)[4] = odom.quat_wxyz;
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

}  // namespace

double heard_rate_hz(const std::deque<ArrivalTime>& arrivals, bool heard_before) {
  if (arrivals.empty()) return heard_before ? 0 : kNaN;
  const double span_s = std::chrono::duration<double>(arrivals.back() - arrivals.front()).count();
  return span_s > 0 ? static_cast<double>(arrivals.size() - 1) / span_s : kNaN;
}

double closing_speed_mps(const vis_track_t& track, const vis_tracks_t& tracks, const vis_odom_t& odom) {
  if (tracks.utime != odom.utime || !odom.pose_valid || !odom.velocity_valid || !track.velocity_valid) return kNaN;
  const Eigen::Vector3d p_body = vector_of(track.centroid_body_m);
  const double range_m = p_body.norm();
  if (!(range_m > 0)) return kNaN;
  // The vehicle's turning moves the direction, never the range.
  const Eigen::Vector3d v_body =
      R_world_body_of(odom).transpose() * vector_of(track.vel_world_mps) - vector_of(odom.vel_body_mps);
  return -p_body.dot(v_body) / range_m;
}

Direction direction_of(const vis_track_t& track) {
  const double(&p)[3] = track.centroid_body_m;
  return {std::atan2(p[1], p[0]), std::atan2(-p[2], std::hypot(p[0], p[1]))};
}

Attitude attitude_of(const vis_odom_t& odom) {
  const Eigen::Matrix3d R = R_world_body_of(odom);
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)), std::atan2(R(1, 0), R(0, 0))};
}

}  // namespace pelorus
