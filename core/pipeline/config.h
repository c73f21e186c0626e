#pragma once
// All settings of the core: one struct per stage beside its class, gathered here. Defaults live there only.

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

struct PipelineConfig {
  MethodSteps steps;
};

}  // namespace pelorus
