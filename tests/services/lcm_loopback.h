#pragma once
// A private LCM bus on this computer for a test: multicast that leaves no interface (ttl 0), on a port of its own.

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "services/publisher.h"

namespace pelorus::test {

inline std::string loopback_url(int offset = 0, const std::string& options = "") {
  const int port = 20000 + static_cast<int>(::getpid() + offset * 7919) % 30000;
  return "udpm://239.255.76.67:" + std::to_string(port) + "?ttl=0" + options;
}

// Without a multicast route LCM cannot be opened at all.
inline bool lcm_available() { return lcm::LCM(loopback_url()).good(); }

// Collects every message of one type on the channels that match.
template <class Message>
class Listener {
 public:
  Listener(const std::string& url, const std::string& pattern) : lcm_(url) {
    lcm_.subscribe(pattern, &Listener::take, this)->setQueueCapacity(1000);
  }

  // True once `enough` says so; false when the time is over.
  bool wait(const std::function<bool()>& enough, double seconds = 5) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!enough() && std::chrono::steady_clock::now() < end) (void)lcm_.handleTimeout(20);
    return enough();
  }
  bool wait_for(std::size_t count, double seconds = 5) {
    return wait([&] { return messages.size() >= count; }, seconds);
  }

  std::vector<Message> messages;
  std::vector<std::string> channels;

 private:
  void take(const lcm::ReceiveBuffer*, const std::string& channel, const Message* message) {
    messages.push_back(*message);
    channels.push_back(channel);
  }
  lcm::LCM lcm_;
};

// A publication in which no two numbers are alike: whatever is swapped or forgotten shows.
inline Publication rich_publication() {
  Publication p;
  FrameResult& r = p.result;
  r.seq = 4711;
  r.capture_time = Timestamp{1'600'000'000'123'456'789};
  r.state = VisionState::degraded;
  p.reason = StateReason::few_points;
  r.pose_valid = true;
  Vector6d xi;
  xi << 1.1, -2.2, 3.3, 0.1, 0.2, -0.3;
  r.T_world_cam = se3_exp(xi);
  r.T_curr_prev = se3_exp(-0.01 * xi);
  for (int i = 0; i < 6; ++i) {
    r.cov_T_world_cam(i, i) = 1e-4 * (i + 1);
    r.cov_T_curr_prev(i, i) = 1e-6 * (i + 1);
  }
  r.world_confidence = 0.7;
  r.reset_counter = 3;
  r.report.points_static = 321;
  r.report.points_moving = 45;
  r.objects_size = 2;
  for (int k = 0; k < 2; ++k) {
    ObjectState& o = r.objects[static_cast<std::size_t>(k)];
    o.id = BodyId{k + 5};
    o.phase = k == 0 ? ObjectPhase::confirmed : ObjectPhase::coasting;
    o.motion_measured = k == 0;
    o.T_world_obj = se3_exp(0.5 * (k + 1) * xi);
    o.cov_T_world_obj = (2.0 + k) * r.cov_T_world_cam;
    o.M_world = se3_exp(0.02 * (k + 1) * xi);
    o.cov_M_world = (5.0 + k) * r.cov_T_curr_prev;
    o.points = 20 + k;
    o.first_seen = Timestamp{r.capture_time.ns - 3'000'000'000};
    o.last_seen = Timestamp{r.capture_time.ns - k * 100'000'000};
    o.centroid_world = r.T_world_cam * Eigen::Vector3d(0.3 + k, -0.2, 4.0);
    o.extent_m = Eigen::Vector3d(0.5, 0.6, 0.7);
    o.outline[0] = {10.5F, 20.5F};
    o.outline[1] = {30.25F, 21.0F};
    o.outline[2] = {25.0F, 44.0F};
    o.outline_size = 3;
  }
  p.step = std::chrono::milliseconds(50);
  p.release_due = r.capture_time + std::chrono::milliseconds(80);
  p.released = p.release_due + std::chrono::microseconds(321);
  p.pairs_dropped = 9;
  return p;
}

}  // namespace pelorus::test
