#pragma once
// What Pipeline::step works on; one member function per step of the method, in the order of the step.

#include <optional>

#include "core/pipeline/pipeline.h"
#include "core/refine/ego_window.h"

namespace pelorus {

struct Pipeline::State {
  State(const PipelineConfig& config, const StereoRig& rig, const PipelineWorkers& workers);

  void begin(const StereoFrame& frame, Shed what_to_shed);
  void match_points(const StereoFrame& frame);  // 5.1: the unified matched set, two clouds
  void measure_noise();                         // until the ego motion is found for the first time
  void partition_coarsely();                    // 5.1, 6.1 steps 2-3
  void find_world();                            // 5.2, 6.1 step 4
  void split_static_from_moving();              // 5.2.1, step 5
  void filter_static_and_moving();              // 5.2.2, 5.2.3, step 6
  void fit_ego_motion();
  void refine_ego_motion();  // by what the window found
  void follow_bodies();      // 6.2 step 2
  void find_new_bodies();    // 6.1 step 7, 5.2.4
  void settle_bodies();      // section 4: trajectories; registry
  void start_points();
  void give_to_window();
  void lose_track();
  void draw_towards_window();
  void publish();

  [[nodiscard]] bool ego_found() const { return ego_outcome == StageOutcome::ok; }
  void collect_fixed();
  [[nodiscard]] RegistrySteps registry_steps() const;
  void learn_sigma(double rate);
  void drop_unexplained();
  void choose_refill_areas();
  void publish_object(const MovingBody& body, ObjectState& object);
  void collect_members_px(const MovingBody& body);
  void collect_model_px(const MovingBody& body);
  // Convex outline of the points, grown about their mean; returns its number of vertices.
  static int outline_of(std::span<const Eigen::Vector2d> points, double grow, std::array<OutlinePoint, 16>& outline);

  PipelineConfig config;
  StereoRig rig;
  InlineWorker inline_worker;
  PipelineWorkers workers;  // absent ones replaced by the inline one
  FrontEnd front_end;
  Grouping grouping;
  Grouping moving_grouping;
  TwoFrameBa two_frame_ba;
  StaticNet net;
  EgoWindow ego_window;
  Registry registry;

  // Of the present step.
  Shed shed = Shed::nothing;
  PointPairs pairs;
  std::vector<const Track*> track_of_pair;
  const Partition* coarse = nullptr;  // of `grouping`
  std::vector<PointRole> roles;
  std::vector<double> chi2_static;
  std::vector<BodyId> owner;
  std::vector<PointIndex> fixed;
  std::vector<PointIndex> open;
  std::vector<BodyPrediction> predictions;
  MotionFit ego;
  StageOutcome ego_outcome = StageOutcome::not_run;
  WorldStep world;
  double world_confidence = 0;
  std::span<const TrackId> misfits;  // of the window

  // Remembered.
  bool started = false;
  std::uint64_t steps = 0;  // seeds the draws: live and replayed pictures get the same, whatever their numbers
  Timestamp last_time;
  std::uint64_t last_seq = 0;
  Rigid3 T_world_cam = Rigid3::Identity();
  Matrix6d cov_T_world_cam = Matrix6d::Zero();
  Vector6d twist_cam = Vector6d::Zero();  // per second: T_world_cam <- T_world_cam * exp(twist dt)
  bool twist_known = false;
  Rigid3 T_world_cam_given = Rigid3::Identity();  // as published, of the frame the window works on
  Rigid3 H_since_given = Rigid3::Identity();      // camera motion since that frame
  bool lost = false;
  Timestamp lost_since;
  Vector6d lost_twist = Vector6d::Zero();  // just before
  bool noise_known = false;
  StaticMotions static_motions;
  double sigma_px = 0.25;
  int reset_counter = 0;
  std::vector<double> residuals;
  std::vector<double> depths;
  std::vector<WindowObservation> observations;
  std::vector<WindowObservation> before;
  std::vector<TrackId> rejected;
  std::vector<RefillArea> refill_areas;
  std::vector<Eigen::Vector2d> outline_points;  // scratch of outline_of
  std::vector<PointView> views;
  FrameResult result;
};

}  // namespace pelorus
