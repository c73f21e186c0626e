#pragma once
// evaluate: one run against its truth, all metrics of method.md section 10 at once. Pure.

#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/association.h"
#include "core/evaluation/consistency.h"
#include "core/evaluation/motion_error.h"
#include "core/evaluation/records.h"
#include "core/evaluation/tracking_score.h"
#include "core/evaluation/trajectory_error.h"

namespace pelorus {

struct EvaluationConfig {
  AssociationConfig association;
  TrackingConfig tracking;
};

// What can be said without truth.
struct RunFacts {
  std::size_t frames = 0;
  std::size_t frames_with_pose = 0;
  std::size_t frames_missed = 0;        // gaps that were bridged
  std::array<std::size_t, 7> states{};  // frames per VisionState
  int resets = 0;
  std::vector<BodyId> confirmed;  // ids that were ever confirmed
};

struct BodyEvaluation {
  std::string name;
  BodyScore score;
  MotionError motion;
  Consistency consistency;
};

struct Evaluation {
  RunFacts facts;
  std::optional<TrajectoryError> camera;  // absent without two common poses
  std::optional<Consistency> camera_consistency;
  bool knows_bodies = false;           // false: the rest is empty
  std::vector<BodyEvaluation> bodies;  // those that move at some time
  TrackingScore tracking;
  Consistency object_consistency;  // over all bodies
};

[[nodiscard]] RunFacts run_facts(const EstimatedRun& run);
[[nodiscard]] Evaluation evaluate(const EstimatedRun& run, const Truth& truth, const EvaluationConfig& config);

}  // namespace pelorus
