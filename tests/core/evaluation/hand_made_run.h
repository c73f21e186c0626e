#pragma once
// A run and its truth whose errors are known because they are put in by hand: a camera on a curve, bodies on curves of
// their own, the estimate perfect until a test spoils it. The truth's fixed frame differs from the estimate's world.

#include <cmath>

#include "core/evaluation/records.h"

namespace pelorus::test {

constexpr double kFrameInterval_s = 0.1;

inline Rigid3 rigid(const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation_vector) {
  Rigid3 T = Rigid3::Identity();
  T.linear() = so3_exp(rotation_vector);
  T.translation() = translation;
  return T;
}

// Estimate's world in the truth's frame: any fixed motion will do.
inline Rigid3 T_truth_world() { return rigid({3, -2, 1}, {0.3, 0.5, -0.2}); }

inline Rigid3 T_world_cam_at(std::size_t frame) {
  const auto i = static_cast<double>(frame);
  return rigid({0.03 * i, 0.01 * std::sin(0.3 * i), 0.05 * i}, {0.002 * i, 0.01 * i, 0});
}

// Body k moves on a line of its own, turning, 2 m to the right of body k - 1.
inline Rigid3 T_world_body_at(int body, std::size_t frame) {
  const auto i = static_cast<double>(frame);
  return rigid({2.0 * body + 0.02 * i, 0.01 * i, 4 + 0.03 * i}, {0, 0.02 * i, 0.01 * i});
}

struct HandMade {
  EstimatedRun run;
  Truth truth;

  TrueBodyView& body(std::size_t frame, int index) {
    return truth.frames[frame].bodies[static_cast<std::size_t>(index)];
  }
  EstimatedObject& object(std::size_t frame, int index) { return run[frame].objects[static_cast<std::size_t>(index)]; }
};

// Object id k + 1 is body k, confirmed from frame 0, born half a metre beside the body's centre.
inline HandMade hand_made(std::size_t frames, int bodies) {
  HandMade made;
  made.truth.exact = made.truth.knows_bodies = true;
  for (int k = 0; k < bodies; ++k) made.truth.bodies.push_back(std::to_string(k));
  for (std::size_t i = 0; i < frames; ++i) {
    EstimatedFrame frame;
    TrueFrame truth;
    frame.seq = i;
    frame.capture_time = Timestamp{static_cast<std::int64_t>(static_cast<double>(i) * kFrameInterval_s * 1e9)};
    frame.state = VisionState::tracking;
    frame.T_world_cam = T_world_cam_at(i);
    if (i > 0) frame.T_curr_prev = T_world_cam_at(i).inverse() * T_world_cam_at(i - 1);
    truth.T_truth_cam = T_truth_world() * T_world_cam_at(i);
    for (int k = 0; k < bodies; ++k) {
      const Rigid3 T_world_body = T_world_body_at(k, i);
      EstimatedObject object;
      object.id = BodyId{k + 1};
      object.phase = ObjectPhase::confirmed;
      if (i > 0) object.M_world = T_world_body * T_world_body_at(k, i - 1).inverse();
      const Rigid3 motion_since_birth = T_world_body * T_world_body_at(k, 0).inverse();
      const Rigid3 T_world_birth = rigid(T_world_body_at(k, 0).translation() + Eigen::Vector3d(0.5, 0, 0), {0, 0, 0});
      object.T_world_obj = motion_since_birth * T_world_birth;
      object.centroid_world = T_world_body.translation() + Eigen::Vector3d(0.1, 0.05, -0.2);
      frame.objects.push_back(object);
      TrueBodyView view;
      view.body = k;
      view.T_cam_body = T_world_cam_at(i).inverse() * T_world_body;
      view.visible_px = 5000;
      view.moving = true;
      truth.bodies.push_back(view);
    }
    made.run.push_back(frame);
    made.truth.frames.push_back(truth);
  }
  return made;
}

}  // namespace pelorus::test
