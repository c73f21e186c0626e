#pragma once
// All settings of the core: one struct per stage beside its class, gathered here. Defaults live there only.

#include "core/frontend/front_end.h"
#include "core/motion/grouping.h"
#include "core/motion/ray_filter.h"
#include "core/motion/repartition.h"
#include "core/motion/static_group.h"
#include "core/objects/registry.h"

namespace pelorus {

// Each step of the method by its own name, so that its effect can be measured by leaving it out (paper section 7).
struct MethodSteps {
  bool rigidity_grouping = true;    // 5.1; off: proposals from random samples over all points
  bool motion_reassignment = true;  // points move to the motion with the least stereo residual
  bool static_criteria = true;      // 5.2; off: the largest group is the world
  bool bundle_adjustment = true;    // two-frame; off: closed-form 3D-3D alignment
  bool repartition = true;          // 5.2.1
  bool net_filter = true;           // 5.2.2
  bool ray_filter = true;           // 5.2.3
  bool hull_membership = true;      // 5.2.4, point in hull
  bool identity_mismatch = true;    // 5.2.4, correspondence measure
  bool merge_split = true;          // 5.2.4, final step
  bool object_window = true;        // refinement of objects over 10 frames
  bool static_window = true;        // refinement of ego motion over recent and key frames
  bool reidentification = true;     // after occlusion
  bool object_refill = true;        // denser points inside object outlines
  bool motion_prediction = true;    // KLT starts from the body's predicted motion
};

struct EgoMotionConfig {
  int min_static_points = 12;         // fewer: LOST
  int degraded_static_points = 40;    // fewer: DEGRADED
  double degraded_confidence = 0.10;  // world_confidence below it: DEGRADED
  double min_sigma_px = 0.02;         // limits of the pixel deviation learned on line
  double max_sigma_px = 1.0;
  double start_sigma_px = 0.25;
  double sigma_learning_rate = 0.1;  // per frame
  double point_gate_chi2 = 9.0;      // mean over the window above which a point leaves the static scene
  int unexplained_frames = 6;        // a point that fits no body for so long is given up
  double window_pull = 0.05;         // share of the way to the window's pose that each frame takes
  // Turn, or shift by the distance of what is seen, of the pose by what the window says: beyond it the window starts
  // anew.
  double max_window_error_rad = 0.03;
  double lost_inflation = 25.0;  // of the pose covariance after a loss
};

struct PipelineConfig {
  MethodSteps steps;
  FrontEndConfig front_end;
  SeedPointsConfig seed_points;
  GroupingConfig grouping;
  StaticGroupConfig static_group;
  TwoFrameBaConfig two_frame_ba;
  RepartitionConfig repartition;
  RayFilterConfig ray_filter;
  EgoMotionConfig ego_motion;
  BodyWindowConfig static_window;
  MembershipConfig membership;
  IdentityConfig identity;
  MergeConfig merge;
  ReidentificationConfig reidentification;
  RegistryConfig registry;
  BodyWindowConfig object_window{.recent_frames = 6, .key_frames = 4, .max_points = 90, .acceleration_prior = true};
};

}  // namespace pelorus
