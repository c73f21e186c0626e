#pragma once
// Bundle adjustment of one rigid body over a bounded window of recent and key frames: the body's points, constant
// in the body's own frame, and its pose in the camera at each frame (method section 6). The static scene is a body
// too: its frame is `world`. For moving bodies a white-noise-acceleration prior ties successive motions
// (Morris, Wang, Ila 2025; Judd & Gammell 2024). Points are eliminated by Schur complement.
// Thread-bound. O(points * frames^2) per iteration, capped by the configuration; no allocation after warm-up.

#include <array>
#include <cstdint>
#include <vector>

#include "core/model/stage_data.h"

namespace pelorus {

struct BodyWindowConfig {
  int recent_frames = 6;
  int key_frames = 6;
  int key_frame_spacing = 4;       // every this many frames one is kept when it leaves the recent part
  double key_frame_inertia = 1.0;  // multiples of a key frame's own information that resist its change
  double view_change_rad = 0.03;   // change of view at which a frame's measurements count half
  int max_points = 400;            // in the adjustment; above it the longest observed are taken
  int iterations = 2;
  double robust_chi2 = 16.0;  // Geman-McClure scale per observation, 3 degrees of freedom
  bool acceleration_prior = false;
  double sigma_acceleration_mps2 = 0.3;  // white noise, per sqrt(Hz)
  double sigma_acceleration_radps2 = 0.3;
};

inline constexpr int kMaxWindowFrames = 16;
inline constexpr int kMaxWindowUnknowns = 6 * kMaxWindowFrames;

struct WindowObservation {
  TrackId track;
  Eigen::Vector3d z_px = Eigen::Vector3d::Zero();
  double sigma_px = 0.25;
};

// A point of the body in the body's own frame.
struct BodyPoint {
  TrackId track;
  Eigen::Vector3d p_body = Eigen::Vector3d::Zero();
  std::uint32_t seen = 0;                                // bit s: observed in frame slot s
  std::array<Eigen::Vector3d, kMaxWindowFrames> z_px{};  // by frame slot
  double sigma_px = 0.25;
  double chi2_mean = 0;  // over its observations, after the last adjustment
  int observations = 0;
};

class BodyWindow {
 public:
  explicit BodyWindow(const BodyWindowConfig& config);
  void clear();
  // Adds a frame: the expected pose, the camera's pose in the world (for the prior), what was seen of the body.
  // Points new to the window start at their triangulation.
  void add_frame(const StereoRig& rig, Timestamp time, const Rigid3& T_cam_body, const Rigid3& T_world_cam,
                 std::span<const WindowObservation> observations);
  // Outcomes: ok; too_few_points (fewer than 3 shared points: the pose stays as given); degenerate.
  StageOutcome adjust(const StereoRig& rig);

  [[nodiscard]] int frames() const { return static_cast<int>(frames_.size()); }
  // Adjusted pose of the newest frame, and of the one before it.
  [[nodiscard]] const Rigid3& T_cam_body() const { return frames_.back().T_cam_body; }
  [[nodiscard]] const Rigid3& T_cam_body_previous() const { return frames_[frames_.size() - 2].T_cam_body; }
  // Covariance of the newest pose, and of the last step's motion H = T_cam_body * T_cam_body_previous^-1
  // (left perturbations, scaled by the residuals).
  [[nodiscard]] const Matrix6d& cov_T_cam_body() const { return cov_T_cam_body_; }
  [[nodiscard]] const Matrix6d& cov_H_curr_prev() const { return cov_H_; }
  [[nodiscard]] double sigma_scale() const { return sigma_scale_; }  // residuals' deviation over the assumed one
  [[nodiscard]] std::span<const BodyPoint> points() const { return points_; }
  [[nodiscard]] const BodyPoint* find(TrackId track) const;
  void remove(TrackId track);
  // The same body in a frame of other origin and axes.
  void change_frame(const Rigid3& T_new_old);

 private:
  // As large as the window may get, so that they need no heap.
  using Information = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxWindowUnknowns, kMaxWindowUnknowns>;
  using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxWindowUnknowns, 1>;

  struct Frame {
    int slot = 0;
    Timestamp time;
    Rigid3 T_cam_body = Rigid3::Identity();
    Rigid3 T_world_cam = Rigid3::Identity();
    std::int64_t number = 0;
    double weight = 1.0;  // of its measurements
    int unknown = -1;     // index of its six unknowns, -1 = held fixed
  };
  void make_room();
  [[nodiscard]] std::uint32_t newest_bit() const { return 1u << frames_.back().slot; }  // in BodyPoint::seen
  [[nodiscard]] BodyPoint* point_of(TrackId track);
  [[nodiscard]] int rank(const BodyPoint& point) const;
  void drop_frame(std::size_t index);
  [[nodiscard]] std::size_t least_useful_key_frame(std::size_t keys) const;
  [[nodiscard]] int number_unknowns();
  void choose_points();
  [[nodiscard]] double accumulate_points(const StereoRig& rig);
  void weigh_frames();
  void add_inertia();
  void accumulate_prior();
  void apply_update(const Unknowns& xi);
  void judge_points(const StereoRig& rig);
  void measure_covariance();

  struct Reduced {
    Information S;
    Unknowns g;
  };
  struct PointBlock {
    int point = 0;
    bool usable = false;
    Eigen::Matrix3d V_inv;
    Eigen::Vector3d b;
    int terms = 0;
    std::array<int, kMaxWindowFrames> unknown;
    std::array<Eigen::Matrix<double, 6, 3>, kMaxWindowFrames> W;
  };

  BodyWindowConfig config_;
  std::vector<Frame> frames_;  // oldest first
  std::vector<BodyPoint> points_;
  std::vector<PointBlock> blocks_;
  Reduced reduced_;
  std::array<Matrix6d, kMaxWindowFrames> own_information_;  // of each frame, points taken as known
  std::uint32_t free_slots_ = 0;
  std::int64_t next_number_ = 0;
  Matrix6d cov_T_cam_body_ = Matrix6d::Zero();
  Matrix6d cov_H_ = Matrix6d::Zero();
  double sigma_scale_ = 1.0;
};

}  // namespace pelorus
