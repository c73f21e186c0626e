#pragma once
// Every struct that crosses a stage, in the order in which data flows. Aggregates with values for defaults,
// indices instead of copies, no virtual functions, no shared ownership. Frames and units: CONVENTIONS, frames.
// Method sections 1-8; ARCHITECTURE, nouns. Pure data: any thread may hold a copy.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/image.h"
#include "core/base/time.h"
#include "core/geometry/stereo_rig.h"
#include "core/geometry/transform.h"
#include "core/model/frame_report.h"

namespace pelorus {

// One rectified stereo pair; the views point into storage of the caller, valid during Pipeline::step only.
struct StereoFrame {
  std::uint64_t seq = 0;  // counts captured pairs, so that a gap shows
  Timestamp capture_time;
  ImageView left;
  ImageView right;
};

// A stereo measurement and its triangulation (StereoRig::triangulate).
struct StereoPoint {
  Eigen::Vector3d z_px = Eigen::Vector3d::Zero();   // (u_left, v, u_right), rectified
  Eigen::Vector3d p_cam = Eigen::Vector3d::Zero();  // [m]
};

inline constexpr int kPastFrames = 4;  // with prev: the longest common history of 5 frames (method section 4)

// A point seen in all four images of a step: prev left/right, curr left/right (paper 5.1, Fig. 2).
struct PointPair {
  TrackId track;
  StereoPoint prev;
  StereoPoint curr;
  double sigma_px = 0.25;          // standard deviation of one pixel coordinate of this point
  double match_error = 0;          // of the tracker: 1 - normalised correlation
  int age = 0;                     // frames since birth, >= 1
  BodyId previous_body = kNoBody;  // the body this track belonged to after the previous step
  // Older measurements, past[0] = two frames back: a one-step change is weak evidence, a five-step change is not.
  std::array<Eigen::Vector3d, kPastFrames> past;
  int past_size = 0;
};

inline constexpr std::size_t kMaxPoints = 2000;  // of a step, whatever the configuration says

using PointIndex = std::int32_t;  // into the PointPairs of the step
using PointPairs = std::span<const PointPair>;

// A proposed or accepted set of points that move as one rigid body during the step.
struct Group {
  std::vector<PointIndex> members;          // capacity reserved at construction, ascending
  Rigid3 H_curr_prev = Rigid3::Identity();  // apparent motion: p_curr = H_curr_prev * p_prev
  Matrix6d cov_H = Matrix6d::Zero();        // of the left perturbation of H_curr_prev
  double rms_px = 0;                        // of the members' reprojection residuals, per coordinate
};

// The points of a step divided by motion: group_of[i] is the index of point i's group, or -1 for an outlier.
struct Partition {
  std::vector<Group> groups;
  std::vector<std::int32_t> group_of;
};

// What a point is held to be in this step (method section 7).
enum class PointRole : std::uint8_t {
  unknown,
  fixed,    // moves with the static scene
  suspect,  // fits the static motion, but stands among moving points: not used for the ego motion (5.2.2)
  moving,   // does not fit the static motion
  outlier   // fits no body: mismatch, particle, caustic
};

enum class VisionState : std::uint8_t { init, tracking, degraded, lost, camera_fault, calibration_fault, standby };
[[nodiscard]] const char* to_text(VisionState state);

enum class ObjectPhase : std::uint8_t { tentative, confirmed, coasting, ended };
[[nodiscard]] const char* to_text(ObjectPhase phase);

struct OutlinePoint {
  float u_px = 0;
  float v_px = 0;
};

// A moving body as published. T_world_obj: origin at the robust centroid of its points at birth, axes then
// parallel to world. M_world maps a body point's world position at the previous frame to that at this frame.
struct ObjectState {
  BodyId id;
  ObjectPhase phase = ObjectPhase::tentative;
  bool motion_measured = false;  // false while coasting: pose and motion are extrapolated
  Rigid3 T_world_obj = Rigid3::Identity();
  Matrix6d cov_T_world_obj = Matrix6d::Zero();  // given the camera's pose, whose own uncertainty is not in it
  Rigid3 M_world = Rigid3::Identity();
  Matrix6d cov_M_world = Matrix6d::Zero();
  int points = 0;  // that support this frame's motion
  Timestamp first_seen;
  Timestamp last_seen;
  Eigen::Vector3d centroid_world = Eigen::Vector3d::Zero();  // of the points seen now (extrapolated when coasting)
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();        // box of the seen points, object axes
  std::array<OutlinePoint, 16> outline{};                    // convex outline in the left image
  int outline_size = 0;
};

inline constexpr int kMaxObjects = 16;

// What one step publishes. Owns no heap memory: publishing is one plain copy. T_world_cam is meaningless
// unless pose_valid: a lost system says so, it never repeats the last pose with a good flag.
struct FrameResult {
  std::uint64_t seq = 0;
  Timestamp capture_time;
  VisionState state = VisionState::init;
  bool pose_valid = false;
  Rigid3 T_world_cam = Rigid3::Identity();
  Matrix6d cov_T_world_cam = Matrix6d::Zero();
  Rigid3 T_curr_prev = Rigid3::Identity();  // H_static of this step
  Matrix6d cov_T_curr_prev = Matrix6d::Zero();
  double world_confidence = 0;   // 0..1, margin of the static group over the runner-up (5.2)
  bool world_ambiguous = false;  // it is too small: another group might be the world (DEGRADED)
  int reset_counter = 0;         // + 1 after each loss
  int objects_size = 0;
  std::array<ObjectState, kMaxObjects> objects{};
  FrameReport report;

  [[nodiscard]] std::span<const ObjectState> objects_view() const {
    return {objects.data(), static_cast<std::size_t>(objects_size)};
  }
};

// A point as a picture needs it: Pipeline::points().
struct PointView {
  TrackId track;
  StereoPoint curr;
  BodyId body = kNoBody;
  int age = 0;
};

}  // namespace pelorus
