#include "firmware-host/pelorus/eval/eval_json.h"

#include <limits>

#include "firmware-host/pelorus/json_object.h"

namespace pelorus {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::string statistics_json(const ErrorStatistics& statistics) {
  if (statistics.count == 0) return "null";
  return JsonObject()
      .integer("count", static_cast<long long>(statistics.count))
      .number("mean", statistics.mean)
      .number("median", statistics.median)
      .number("rmse", statistics.rmse)
      .number("max", statistics.max)
      .str();
}

std::string consistency_json(const Consistency& nees) {
  if (nees.count == 0) return "null";
  return JsonObject()
      .integer("count", static_cast<long long>(nees.count))
      .number("mean", nees.mean_nees)
      .number("median", nees.median_nees)
      .number("band_low", nees.band_low)
      .number("band_high", nees.band_high)
      .flag("inside_band", nees.is_inside_band())
      .number("share_below_95_percent_bound", nees.share_inside)
      .str();
}

std::string goals_json(const Goals& goals) {
  JsonObject json;
  for (const synthetic::GoalField& field : synthetic::kGoalFields) {
    if (const auto& value = goals.*field.member) json.number(field.key, *value);
  }
  return json.str();
}

std::string camera_json(const TrajectoryError& camera, const std::optional<Consistency>& nees) {
  JsonObject json;
  json.integer("poses", static_cast<long long>(camera.poses))
      .number("path_length_m", camera.path_length_m)
      .number("ate_rmse_m", camera.ate_rmse_m)
      .raw("absolute_m", statistics_json(camera.absolute_m))
      .raw("absolute_rad", statistics_json(camera.absolute_rad))
      .raw("step_m", statistics_json(camera.step_m))
      .raw("step_rad", statistics_json(camera.step_rad))
      .number("final_drift_m", camera.final_drift_m)
      .number("final_drift_rad", camera.final_drift_rad)
      .number("final_drift_percent", camera.final_drift_percent.value_or(kUnknown));
  if (camera.kitti) {
    json.raw("kitti_drift", JsonObject()
                                .integer("sub_paths", static_cast<long long>(camera.kitti->count))
                                .number("translation_percent", camera.kitti->translation_percent)
                                .number("rotation_deg_per_100m", camera.kitti->rotation_deg_per_100m)
                                .str());
  } else {
    json.raw("kitti_drift", "null");
  }
  return json.raw("nees", nees ? consistency_json(*nees) : "null").str();
}

std::string body_json(const BodyEvaluation& body) {
  std::vector<std::string> ids;
  for (const BodyId id : body.score.ids) ids.push_back(std::to_string(id.value));
  return JsonObject()
      .text("name", body.name)
      .raw("object_ids", json_array(ids))
      .raw("step_m", statistics_json(body.motion.step_m))
      .raw("step_rad", statistics_json(body.motion.step_rad))
      .raw("since_birth_m", statistics_json(body.motion.since_birth_m))
      .raw("since_birth_rad", statistics_json(body.motion.since_birth_rad))
      .integer("frames_on_show", static_cast<long long>(body.score.frames_on_show))
      .integer("frames_covered", static_cast<long long>(body.score.frames_covered))
      .number("coverage", body.score.frames_on_show > 0 ? body.score.coverage() : kUnknown)
      .integer("identity_switches", body.score.identity_switches)
      .number("time_to_detection_s", body.score.time_to_detection_s.value_or(kUnknown))
      .raw("nees", consistency_json(body.consistency))
      .str();
}

std::string objects_json(const Evaluation& evaluation) {
  std::vector<std::string> bodies;
  for (const BodyEvaluation& body : evaluation.bodies) bodies.push_back(body_json(body));
  std::vector<std::string> false_objects;
  for (const FalseObject& object : evaluation.tracking.false_objects) {
    false_objects.push_back(JsonObject()
                                .integer("object_id", object.id.value)
                                .integer("frames", static_cast<long long>(object.frames))
                                .flag("duplicate", object.duplicate)
                                .text("resting_body", object.resting_body)
                                .str());
  }
  return JsonObject()
      .raw("bodies", json_array(bodies))
      .number("right_count_share", evaluation.tracking.right_count_share.value_or(kUnknown))
      .number("right_count_settled_share", evaluation.tracking.right_count_settled_share.value_or(kUnknown))
      .raw("false_objects", json_array(false_objects))
      .number("false_per_1000_frames", evaluation.tracking.false_per_1000_frames)
      .raw("nees", consistency_json(evaluation.object_consistency))
      .str();
}

}  // namespace

std::string to_json(const RunEvaluation& run) {
  const RunFacts& facts = run.evaluation.facts;
  JsonObject states;
  for (std::size_t i = 0; i < facts.states.size(); ++i) {
    states.integer(to_text(static_cast<VisionState>(i)), static_cast<long long>(facts.states[i]));
  }
  std::vector<std::string> confirmed;
  for (const BodyId id : facts.confirmed) confirmed.push_back(std::to_string(id.value));
  JsonObject json;
  json.text("dataset", run.dataset)
      .text("run", run.folder)
      .raw("goals", goals_json(run.goals))
      .raw("incomplete", run.incomplete ? json_text(*run.incomplete) : "null")
      .integer("frames", static_cast<long long>(facts.frames))
      .integer("frames_with_pose", static_cast<long long>(facts.frames_with_pose))
      .integer("frames_missing", static_cast<long long>(run.lost ? run.lost->missing : facts.frames_missed))
      .number("frames_unreadable", run.lost ? static_cast<double>(run.lost->unreadable) : kUnknown)
      .number("frames_dropped", run.lost ? static_cast<double>(run.lost->dropped) : kUnknown)
      .integer("resets", facts.resets)
      .raw("states", states.str())
      .raw("confirmed_object_ids", json_array(confirmed))
      .number("step_median_ms", run.step_times ? run.step_times->median_ms : kUnknown)
      .number("step_p99_ms", run.step_times ? run.step_times->p99_ms : kUnknown)
      .flag("has_truth", run.has_truth)
      .flag("exact_truth", run.exact_truth)
      .text("truth_origin", run.truth_origin)
      .raw("truth_doubt", run.doubt ? json_text(*run.doubt) : "null");
  json.raw("camera",
           run.evaluation.camera ? camera_json(*run.evaluation.camera, run.evaluation.camera_consistency) : "null");
  json.raw("objects", run.evaluation.knows_bodies ? objects_json(run.evaluation) : "null");
  return json.str();
}

}  // namespace pelorus
