#pragma once
// A moving rigid body as the registry remembers it (paper 6.1, the table of objects; method section 8). Plain data
// with its refinement window; indices are into the pairs of the present step.

#include <utility>
#include <vector>

#include "core/frontend/surf.h"
#include "core/model/stage_data.h"
#include "core/refine/body_window.h"

namespace pelorus {

// A point of the body's model, in the frame fixed at its birth: what the hull and re-identification look at.
struct ModelPoint {
  TrackId track;
  Eigen::Vector3d p_obj = Eigen::Vector3d::Zero();
  SurfDescriptor descriptor{};
  std::int8_t laplacian = 0;
  bool has_descriptor = false;
  std::int64_t last_frame = 0;  // number of the step in which it was last seen
  bool of_birth = true;         // measured in the frame of the body's birth, not in one that was guessed since
};

inline constexpr std::size_t kMaxModelPoints = 512;  // of a body

struct MovingBody {
  explicit MovingBody(const BodyWindowConfig& window_config) : window(window_config) {}
  explicit MovingBody(BodyWindow&& kept) : window(std::move(kept)) {}
  // As new, with the storage it has.
  void forget() {
    std::vector<PointIndex> kept_members = std::move(members);
    std::vector<ModelPoint> kept_model = std::move(model);
    *this = MovingBody(std::move(window));
    window.clear();
    members = std::move(kept_members);
    members.clear();
    model = std::move(kept_model);
    model.clear();
  }

  BodyId id;
  ObjectPhase phase = ObjectPhase::tentative;
  Timestamp first_seen;
  Timestamp last_seen;
  int frames_measured = 0;
  int frames_missed = 0;    // in a row
  int frames_apart = 0;     // in a row: its points stand in separate parts
  double evidence = 0;      // sum of log-likelihood ratios, own motion against static
  bool measured = false;    // in this step
  int recoveries_left = 0;  // tries to find the frame of its birth again
  bool place_known = true;  // false from a loss of the camera's own motion until the body is recognised
  Rigid3 T_cam_obj = Rigid3::Identity();
  Rigid3 T_world_obj = Rigid3::Identity();
  Matrix6d cov_T_world_obj = Matrix6d::Zero();
  // Of that: the steps since the frame of its birth was taken for known (left perturbations, world), and how well that
  // frame is known (right ones, body). The second is zero until it was out of sight.
  Matrix6d cov_steps = Matrix6d::Zero();
  Matrix6d cov_birth_frame = Matrix6d::Zero();
  Rigid3 M_world = Rigid3::Identity();
  Matrix6d cov_M_world = Matrix6d::Zero();
  Vector6d twist_obj = Vector6d::Zero();    // per second, in the object frame: T_obj <- T_obj * exp(twist dt)
  Rigid3 H_curr_prev = Rigid3::Identity();  // predicted, then measured
  std::vector<PointIndex> members;
  std::vector<ModelPoint> model;
  Eigen::Vector3d centroid_obj = Eigen::Vector3d::Zero();
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d birth_centroid_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d birth_camera_world = Eigen::Vector3d::Zero();
  BodyWindow window;
};

}  // namespace pelorus
