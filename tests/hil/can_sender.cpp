// The service's CAN output without cameras: results of a known dive, published at a rate onto a real interface, with
// the LCM messages of the same results beside them as lines of JSON. What the bus carries is then compared with those.
// usage: can_sender INTERFACE SETS RATE_HZ OUT.jsonl [fd]
// Prints the publisher's status whenever it changes.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include "services/can/can_publisher.h"
#include "services/lcm_messages.h"

namespace pelorus {
namespace {

using Clock = std::chrono::steady_clock;
constexpr Duration kLatency = std::chrono::milliseconds(80);

Timestamp wall_clock() {
  return Timestamp{std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()).count()};
}

Rigid3 forward_mounting() {
  Rigid3 T_body_cam = Rigid3::Identity();
  T_body_cam.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // cam x starboard, y down, z forward
  T_body_cam.translation() = Eigen::Vector3d(0.8, -0.1, 0.3);
  return T_body_cam;
}

// Forward with slow turns in all axes; now and then lost, once reset.
class KnownDive {
 public:
  Publication next(Timestamp released) {
    ++number_;
    const Rigid3 T_prev = T_start_body_;
    T_start_body_ = T_start_body_ * step_at(number_);
    const Rigid3 T_cam_body = T_body_cam_.inverse();
    Publication p;
    FrameResult& r = p.result;
    r.seq = number_;
    r.capture_time = released + (-kLatency);
    p.released = released;
    p.step = number_ > 1 ? r.capture_time - last_time_ : Duration{};
    last_time_ = r.capture_time;
    r.state = number_ % 40 == 39 ? VisionState::lost : VisionState::tracking;
    r.pose_valid = r.state == VisionState::tracking;
    r.reset_counter = static_cast<int>(number_ / 40);
    r.world_confidence = 0.2;
    r.report.points_static = 120;
    r.T_world_cam = T_cam_body * T_start_body_ * T_body_cam_;
    r.T_curr_prev = T_cam_body * T_start_body_.inverse() * T_prev * T_body_cam_;
    r.cov_T_curr_prev = 1e-7 * Matrix6d::Identity();
    r.cov_T_world_cam = 1e-4 * Matrix6d::Identity();
    add_object(r);
    return p;
  }
  [[nodiscard]] const Rigid3& T_body_cam() const { return T_body_cam_; }

 private:
  static Rigid3 step_at(std::uint64_t k) {
    const double t = 0.05 * static_cast<double>(k);
    Vector6d twist;
    twist << 0.06 + 0.02 * std::sin(t), 0.01 * std::cos(2 * t), -0.004, 0.002 * std::sin(t), 0.003, 0.01 * std::cos(t);
    return se3_exp(twist);
  }
  void add_object(FrameResult& r) const {
    ObjectState& object = r.objects[0];
    object.id = BodyId{4};
    object.phase = ObjectPhase::confirmed;
    object.motion_measured = true;
    object.points = 30;
    object.centroid_world = r.T_world_cam * Eigen::Vector3d(0.4, -0.3, 5 + std::sin(0.1 * static_cast<double>(r.seq)));
    object.M_world.translation() = Eigen::Vector3d(0.01, 0, 0.02);
    r.objects_size = 1;
  }

  Rigid3 T_body_cam_ = forward_mounting();
  Rigid3 T_start_body_ = Rigid3::Identity();
  Timestamp last_time_;
  std::uint64_t number_ = 0;
};

std::string numbers(const double* values, int count) {
  std::string out = "[";
  char text[40];
  for (int i = 0; i < count; ++i) {
    std::snprintf(text, sizeof text, "%.12g", values[i]);
    out += (i > 0 ? "," : "") + (std::isfinite(values[i]) ? std::string(text) : std::string("null"));
  }
  return out + "]";
}

void write_lcm(std::FILE* out, const Publication& p, const BodyFrames& frames) {
  const vis_odom_t odom = odom_message(p, frames);
  const vis_tracks_t tracks = tracks_message(p, frames);
  const double none[3] = {NAN, NAN, NAN};
  const double* body = tracks.tracks.empty() ? none : tracks.tracks[0].centroid_body_m;
  std::fprintf(out,
               "{\"number\":%lld,\"utime\":%lld,\"released_ns\":%lld,\"state\":\"%s\",\"quality_percent\":%d,"
               "\"reset_counter\":%d,\"vel_body_mps\":%s,\"step_s\":%.9g,\"step_pos_m\":%s,\"pos_m\":%s,"
               "\"quat_wxyz\":%s,\"body_m\":%s}\n",
               static_cast<long long>(odom.seq), static_cast<long long>(odom.utime),
               static_cast<long long>(p.released.ns), odom.state_text.c_str(), odom.quality_percent, odom.reset_counter,
               numbers(odom.vel_body_mps, 3).c_str(), odom.step_s, numbers(odom.step_pos_m, 3).c_str(),
               numbers(odom.pos_m, 3).c_str(), numbers(odom.quat_wxyz, 4).c_str(), numbers(body, 3).c_str());
}

int run(const char* interface, int sets, double rate_hz, const char* path, bool fd) {
  std::FILE* out = std::fopen(path, "w");
  if (out == nullptr) return 6;
  KnownDive dive;
  CanConfig config;
  config.enabled = true;
  config.interface = interface;
  config.fd = fd;
  config.retry_ms = 200;
  CanPublisher publisher(config, dive.T_body_cam(), kLatency, 0x5EAF100D);
  const BodyFrames frames(dive.T_body_cam());
  CanBusState shown = CanBusState::warning;
  Clock::time_point due = Clock::now();
  for (int k = 0; k < sets; ++k) {
    const Publication p = dive.next(wall_clock());
    publisher.publish(p);
    write_lcm(out, p, frames);
    due += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate_hz));
    while (Clock::now() < due) {
      const Duration left = due - Clock::now();
      std::this_thread::sleep_for(std::max(Duration{}, std::min<Duration>(publisher.tend(), left)));
    }
    const CanStatus status = publisher.status();
    if (status.bus.state != shown) std::printf("%s\n", status_text(status, interface).c_str());
    shown = status.bus.state;
    std::fflush(stdout);
  }
  const CanStatus end = publisher.status();
  std::printf("{\"sent\":%llu,\"dropped\":%llu,\"unheard\":%llu,\"opened\":%llu}\n",
              static_cast<unsigned long long>(end.sets_sent), static_cast<unsigned long long>(end.sets_dropped),
              static_cast<unsigned long long>(end.sets_unheard), static_cast<unsigned long long>(end.opened));
  return std::fclose(out) == 0 ? 0 : 6;
}

}  // namespace
}  // namespace pelorus

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "usage: can_sender INTERFACE SETS RATE_HZ OUT.jsonl [fd]\n");
    return 2;
  }
  const bool fd = argc > 5 && std::strcmp(argv[5], "fd") == 0;
  return pelorus::run(argv[1], std::atoi(argv[2]), std::atof(argv[3]), argv[4], fd);
}
