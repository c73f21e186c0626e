#include "core/evaluation/evaluation.h"

#include <algorithm>
#include <set>

#include "core/base/check.h"

namespace pelorus {
namespace {

bool ever_moves(const Truth& truth, int body) {
  return std::any_of(truth.frames.begin(), truth.frames.end(), [&](const TrueFrame& frame) {
    const TrueBodyView* view = frame.find(body);
    return view && view->moving;
  });
}

}  // namespace

RunFacts run_facts(const EstimatedRun& run) {
  RunFacts facts;
  std::set<BodyId> confirmed;
  for (const EstimatedFrame& frame : run) {
    ++facts.frames;
    facts.frames_with_pose += frame.T_world_cam.has_value();
    facts.frames_missed += static_cast<std::size_t>(frame.frames_missed);
    ++facts.states[static_cast<std::size_t>(frame.state)];
    facts.resets = frame.reset_counter;
    for (const EstimatedObject& object : frame.objects) {
      if (object.phase == ObjectPhase::confirmed) confirmed.insert(object.id);
    }
  }
  facts.confirmed.assign(confirmed.begin(), confirmed.end());
  return facts;
}

Evaluation evaluate(const EstimatedRun& run, const Truth& truth, const EvaluationConfig& config) {
  PELORUS_CHECK(truth.frames.size() == run.size(), "truth must have one entry per frame of the run");
  Evaluation evaluation;
  evaluation.facts = run_facts(run);
  const std::vector<PosePair> poses = common_poses(run, truth);
  evaluation.camera = trajectory_error(poses);
  evaluation.camera_consistency = ego_consistency(run, truth);
  evaluation.knows_bodies = truth.knows_bodies;
  const std::optional<Rigid3> T_truth_world = first_pose_alignment(poses);
  if (!truth.knows_bodies || !T_truth_world) return evaluation;

  const std::vector<FrameMatches> matches = associate(run, truth, config.association);
  evaluation.tracking = tracking_score(run, truth, matches, config.tracking);
  std::vector<double> all_nees;
  for (std::size_t i = 0; i < truth.bodies.size(); ++i) {
    const int body = static_cast<int>(i);
    if (!ever_moves(truth, body)) continue;
    const std::vector<double> body_nees = object_nees(run, truth, matches, body, *T_truth_world);
    all_nees.insert(all_nees.end(), body_nees.begin(), body_nees.end());
    evaluation.bodies.push_back({truth.bodies[i], evaluation.tracking.bodies[i],
                                 motion_error(run, truth, matches, body, *T_truth_world), summarize_nees(body_nees)});
  }
  evaluation.object_consistency = summarize_nees(std::move(all_nees));
  return evaluation;
}

}  // namespace pelorus
