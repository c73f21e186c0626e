#include "firmware-host/pelorus/export/trajectory_text.h"

#include <array>
#include <cinttypes>
#include <cstdio>

namespace pelorus {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.12g", value);
  return text.data();
}

// Exact to the nanosecond, which a double would not be.
std::string seconds_text(std::int64_t ns) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%" PRId64 ".%09" PRId64, ns / kSecond_ns, ns % kSecond_ns);
  return text.data();
}

Eigen::Quaterniond rotation_of(const Rigid3& T) {
  Eigen::Quaterniond q = Eigen::Quaterniond(T.linear()).normalized();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

std::string csv_row(const EstimatedFrame& frame, const std::string& who, const std::string& phase, const Rigid3& T,
                    const std::string& points) {
  const Eigen::Quaterniond q = rotation_of(T);
  std::string row = std::to_string(frame.capture_time.ns) + "," + std::to_string(frame.seq) + "," +
                    to_text(frame.state) + "," + who + "," + phase;
  for (int i = 0; i < 3; ++i) row += "," + number(T.translation()(i));
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) row += "," + number(x);
  return row + "," + points + "\n";
}

}  // namespace

std::vector<TimedPose> poses_of(const EstimatedRun& run, const std::optional<BodyId>& body) {
  std::vector<TimedPose> poses;
  for (const EstimatedFrame& frame : run) {
    if (!body && frame.T_world_cam) poses.push_back({frame.capture_time, *frame.T_world_cam});
    if (!body) continue;
    for (const EstimatedObject& object : frame.objects) {
      if (object.id == *body) poses.push_back({frame.capture_time, object.T_world_obj});
    }
  }
  return poses;
}

std::string tum_text(const std::vector<TimedPose>& poses) {
  std::string text;
  for (const TimedPose& pose : poses) {
    const Eigen::Quaterniond q = rotation_of(pose.T_world_x);
    text += seconds_text(pose.time.ns);
    for (int i = 0; i < 3; ++i) text += " " + number(pose.T_world_x.translation()(i));
    for (const double x : {q.x(), q.y(), q.z(), q.w()}) text += " " + number(x);
    text += "\n";
  }
  return text;
}

std::string kitti_text(const std::vector<TimedPose>& poses) {
  std::string text;
  for (const TimedPose& pose : poses) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        text += (row + column == 0 ? "" : " ") + number(pose.T_world_x(row, column));
      }
    }
    text += "\n";
  }
  return text;
}

std::string kitti_times_text(const std::vector<TimedPose>& poses) {
  std::string text;
  for (const TimedPose& pose : poses) text += seconds_text(pose.time.ns - poses.front().time.ns) + "\n";
  return text;
}

std::string csv_text(const EstimatedRun& run) {
  std::string text = "timestamp_ns,seq,state,body,phase,p_x,p_y,p_z,q_w,q_x,q_y,q_z,points\n";
  for (const EstimatedFrame& frame : run) {
    if (frame.T_world_cam) text += csv_row(frame, "camera", "", *frame.T_world_cam, "");
    for (const EstimatedObject& object : frame.objects) {
      text += csv_row(frame, std::to_string(object.id.value), to_text(object.phase), object.T_world_obj,
                      std::to_string(object.points));
    }
  }
  return text;
}

}  // namespace pelorus
