#pragma once
// What is compared: the estimate of a run, frame by frame, and the truth of the same frames. Pure data.
// Frames: `world` is the estimate's, `truth` the truth's own fixed frame; `cam` the rectified left camera.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/time.h"
#include "core/geometry/transform.h"
#include "core/model/stage_data.h"

namespace pelorus {

struct EstimatedObject {
  BodyId id;
  ObjectPhase phase = ObjectPhase::tentative;
  Rigid3 T_world_obj = Rigid3::Identity();
  Rigid3 M_world = Rigid3::Identity();
  int points = 0;
  Eigen::Vector3d centroid_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();
  // Of M_world, left perturbation taken at the centroid, axes of `world`; zero = unknown.
  Matrix6d cov_M_centroid = Matrix6d::Zero();
};

struct EstimatedFrame {
  std::uint64_t seq = 0;
  Timestamp capture_time;
  VisionState state = VisionState::init;
  std::optional<Rigid3> T_world_cam;  // absent = the system said it has no pose
  std::optional<Rigid3> T_curr_prev;  // of the step that led here
  Matrix6d cov_T_curr_prev = Matrix6d::Zero();
  double world_confidence = 0;
  int reset_counter = 0;
  int frames_missed = 0;
  std::vector<EstimatedObject> objects;
};

using EstimatedRun = std::vector<EstimatedFrame>;

// A body of the truth in one frame.
struct TrueBodyView {
  int body = 0;                                // index into Truth::bodies
  Rigid3 T_cam_body = Rigid3::Identity();      // body origin at its centre
  std::optional<Eigen::Vector3d> half_size_m;  // of its box, body axes; absent = unknown
  std::optional<int> visible_px;               // absent = unknown: taken as visible
  bool moving = false;                         // during the step that led to this frame
};

struct TrueFrame {
  std::optional<Rigid3> T_truth_cam;
  std::vector<TrueBodyView> bodies;

  [[nodiscard]] const TrueBodyView* find(int body) const {
    for (const TrueBodyView& view : bodies)
      if (view.body == body) return &view;
    return nullptr;
  }
};

struct Truth {
  std::string origin;               // where it comes from and how far it can be trusted
  bool exact = false;               // synthetic; otherwise a measurement with errors of its own
  bool scale_known = true;          // false: its lengths are too rough to judge drift by
  bool knows_bodies = false;        // false: nothing is known about moving bodies, so nothing can be called false
  std::vector<std::string> bodies;  // names
  std::vector<TrueFrame> frames;    // one per frame of the run, same order
};

}  // namespace pelorus
