#pragma once
// Which estimated object is which true body, frame by frame. Compared in the camera frame of each frame, estimate in
// the estimated and truth in the true camera, so that the drift of the camera's own pose does not matter. An object
// is near a body when the centroid of its points is inside the body's box or, where the box is unknown, near its
// centre. Pairs of the frame before are kept while they stay near (as CLEAR MOT, Bernardin & Stiefelhagen 2008);
// the rest are paired nearest first. Pure; O(objects x bodies) a frame.

#include <vector>

#include "core/evaluation/records.h"

namespace pelorus {

struct AssociationConfig {
  double centre_gate_m = 0.6;     // box unknown: distance of the centroid from the body's centre
  double box_gate_m = 0.15;       // box exactly known: distance of the centroid from the box
  double rough_box_gate_m = 0.5;  // box known as well as people and laser scanners draw it
};

struct ObjectMatch {
  BodyId object;
  int body = 0;
};

struct FrameMatches {
  std::vector<ObjectMatch> pairs;
  // Objects near a moving body that another object is paired with already: a second claim on the same body.
  std::vector<ObjectMatch> duplicates;

  [[nodiscard]] const ObjectMatch* of_object(BodyId object) const;
  [[nodiscard]] const ObjectMatch* of_body(int body) const;
};

// Confirmed and coasting objects only. One entry per frame of the run; empty where no pose or truth is known.
[[nodiscard]] std::vector<FrameMatches> associate(const EstimatedRun& run, const Truth& truth,
                                                  const AssociationConfig& config);

}  // namespace pelorus
