#include "core/evaluation/motion_error.h"

#include <map>

namespace pelorus {
namespace {

const EstimatedObject* find_object(const EstimatedFrame& frame, BodyId id) {
  for (const EstimatedObject& object : frame.objects)
    if (object.id == id) return &object;
  return nullptr;
}

// Where an estimated object and the true body stood when the estimate began.
struct Birth {
  Rigid3 T_world_obj;
  Rigid3 T_world_body;
};

// First frame in which each object exists together with the body's truth: births before the match counts are the
// object's, not the match's, so a displacement is measured from where the estimate itself began.
std::map<BodyId, Birth> find_births(const EstimatedRun& run, const Truth& truth, int body,
                                    const Rigid3& T_truth_world) {
  std::map<BodyId, Birth> births;
  for (std::size_t i = 0; i < run.size() && i < truth.frames.size(); ++i) {
    const std::optional<Rigid3> T_world_body = true_body_in_world(truth.frames[i], body, T_truth_world);
    if (!T_world_body) continue;
    for (const EstimatedObject& object : run[i].objects) {
      births.try_emplace(object.id, Birth{object.T_world_obj, *T_world_body});
    }
  }
  return births;
}

}  // namespace

std::optional<Rigid3> true_body_in_world(const TrueFrame& frame, int body, const Rigid3& T_truth_world) {
  const TrueBodyView* view = frame.find(body);
  if (!view || !frame.T_truth_cam) return std::nullopt;
  return T_truth_world.inverse() * *frame.T_truth_cam * view->T_cam_body;
}

Rigid3 error_in_body_frame(const Rigid3& M_true, const Rigid3& M_world, const Rigid3& T_world_body) {
  return T_world_body.inverse() * M_true.inverse() * M_world * T_world_body;
}

MotionError motion_error(const EstimatedRun& run, const Truth& truth, const std::vector<FrameMatches>& matches,
                         int body, const Rigid3& T_truth_world) {
  std::vector<double> step_m, step_rad, since_birth_m, since_birth_rad;
  const std::map<BodyId, Birth> births = find_births(run, truth, body, T_truth_world);
  for (std::size_t i = 1; i < matches.size(); ++i) {
    const ObjectMatch* match = matches[i].of_body(body);
    const EstimatedObject* object = match ? find_object(run[i], match->object) : nullptr;
    if (!object || object->phase != ObjectPhase::confirmed) continue;
    const std::optional<Rigid3> T_world_curr = true_body_in_world(truth.frames[i], body, T_truth_world);
    if (!T_world_curr) continue;
    const std::optional<Rigid3> T_world_prev = true_body_in_world(truth.frames[i - 1], body, T_truth_world);
    if (T_world_prev) {
      const Rigid3 error = error_in_body_frame(*T_world_curr * T_world_prev->inverse(), object->M_world, *T_world_prev);
      step_m.push_back(error.translation().norm());
      step_rad.push_back(rotation_angle_rad(error.linear()));
    }
    const Birth& birth = births.at(object->id);
    const Rigid3 error = error_in_body_frame(*T_world_curr * birth.T_world_body.inverse(),
                                             object->T_world_obj * birth.T_world_obj.inverse(), birth.T_world_body);
    since_birth_m.push_back(error.translation().norm());
    since_birth_rad.push_back(rotation_angle_rad(error.linear()));
  }
  return {summarize(std::move(step_m)), summarize(std::move(step_rad)), summarize(std::move(since_birth_m)),
          summarize(std::move(since_birth_rad))};
}

}  // namespace pelorus
