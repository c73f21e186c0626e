#include "firmware-host/pelorus/report/page_scene.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/evaluation/motion_error.h"
#include "core/evaluation/trajectory_error.h"
#include "firmware-host/pelorus/json_object.h"
#include "firmware-host/pelorus/report/body_names.h"
#include "firmware-host/pelorus/report/json_numbers.h"
#include "firmware-host/pelorus/report/scene_view.h"

namespace pelorus {
namespace {

constexpr int kPoseDecimals = 5;
constexpr int kPointDecimals = 3;

double seconds_since_start(const EstimatedRun& run, std::size_t frame) {
  return seconds(run[frame].capture_time - run.front().capture_time);
}

std::set<BodyId> confirmed_ids(const ReportInput& input) {
  const std::vector<BodyId>& ids = input.judged.evaluation.evaluation.facts.confirmed;
  return {ids.begin(), ids.end()};
}

std::optional<Rigid3> T_truth_world(const ReportInput& input) {
  if (!input.judged.truth) return std::nullopt;
  return first_pose_alignment(common_poses(input.judged.run, *input.judged.truth));
}

using OutlineAt = std::map<std::pair<Timestamp, BodyId>, const SceneOutline*>;

std::string object_json(const ReportInput& input, const ShownFrames& shown, BodyId id, const OutlineAt& outline_at,
                        const std::vector<ScenePoint>& points, std::size_t limit) {
  JsonNumbers frames(0), poses(kPoseDecimals);
  std::vector<std::string> outlines, phases;
  for (std::size_t i = 0; i < shown.frames.size(); ++i) {
    const EstimatedFrame& frame = input.judged.run[shown.frames[i]];
    for (const EstimatedObject& object : frame.objects) {
      if (object.id != id || object.phase == ObjectPhase::ended || object.phase == ObjectPhase::tentative) continue;
      frames.add(static_cast<double>(i));
      poses.add(object.T_world_obj);
      phases.push_back(object.phase == ObjectPhase::coasting ? "1" : "0");
      JsonNumbers corners(kPointDecimals);
      const auto outline = outline_at.find({frame.capture_time, id});
      if (outline != outline_at.end()) {
        for (const Eigen::Vector3d& corner : outline->second->corners_obj) corners.add(corner);
      }
      outlines.push_back(corners.str());
    }
  }
  JsonNumbers coordinates(kPointDecimals);
  const std::vector<ScenePoint> kept = thinned(points, limit);
  for (const ScenePoint& point : kept) coordinates.add(point.p_body);
  return JsonObject()
      .integer("id", id.value)
      .text("name", object_name(input, id))
      .text("color", css_color(object_color(id)))
      .raw("frame", frames.str())
      .raw("pose", poses.str())
      .raw("coasting", json_array(phases))
      .raw("outline", json_array(outlines))
      .raw("points", coordinates.str())
      .integer("points_total", static_cast<long long>(points.size()))
      .str();
}

// The point of the body that the estimate follows (its own origin), in the body's frame: the body's center is another
// point, and its path would differ from the estimated one without any error.
template <class TruePose>
std::optional<Eigen::Vector3d> followed_point(const EstimatedRun& run, const ErrorSample& first, TruePose&& true_pose) {
  for (std::size_t frame = 0; frame <= first.frame; ++frame) {
    const std::optional<Rigid3> T_world_body = true_pose(frame);
    if (!T_world_body) continue;
    for (const EstimatedObject& object : run[frame].objects) {
      if (object.id == first.object) return T_world_body->inverse() * Eigen::Vector3d(object.T_world_obj.translation());
    }
  }
  return std::nullopt;
}

}  // namespace

ShownFrames shown_frames(const EstimatedRun& run, const PageBudget& budget) {
  std::size_t object_frames = 0;
  for (const EstimatedFrame& frame : run) object_frames += frame.objects.size();
  const auto stride_for = [](std::size_t count, std::size_t limit) { return (count + limit - 1) / limit; };
  ShownFrames shown;
  shown.stride = std::max(
      {std::size_t{1}, stride_for(run.size(), budget.replay_frames), stride_for(object_frames, budget.object_frames)});
  for (std::size_t i = 0; i < run.size(); i += shown.stride) shown.frames.push_back(i);
  return shown;
}

std::string frames_json(const ReportInput& input, const ShownFrames& shown) {
  const EstimatedRun& run = input.judged.run;
  const std::optional<Rigid3> alignment = T_truth_world(input);
  JsonNumbers seq(0), time_s(4), state(0), camera(kPoseDecimals), truth(kPoseDecimals);
  for (const std::size_t frame : shown.frames) {
    seq.add(static_cast<double>(run[frame].seq));
    time_s.add(seconds_since_start(run, frame));
    state.add(static_cast<double>(run[frame].state));
    if (run[frame].T_world_cam) {
      camera.add(*run[frame].T_world_cam);
    } else {
      camera.add_nulls(7);
    }
    if (!alignment) continue;
    const std::optional<Rigid3>& T_truth_cam = input.judged.truth->frames[frame].T_truth_cam;
    if (T_truth_cam) {
      truth.add(Eigen::Vector3d((alignment->inverse() * *T_truth_cam).translation()));
    } else {
      truth.add_nulls(3);
    }
  }
  return JsonObject()
      .integer("stride", static_cast<long long>(shown.stride))
      .raw("seq", seq.str())
      .raw("time_s", time_s.str())
      .raw("state", state.str())
      .raw("camera", camera.str())
      .raw("truth", alignment ? truth.str() : "null")
      .str();
}

std::string objects_json(const ReportInput& input, const ShownFrames& shown, const PageBudget& budget) {
  OutlineAt outline_at;
  for (const SceneOutline& outline : input.outlines) outline_at[{outline.capture_time, outline.body}] = &outline;
  std::map<BodyId, std::vector<ScenePoint>> points_of;
  for (const ScenePoint& point : input.points) points_of[point.body].push_back(point);
  const std::set<BodyId> ids = confirmed_ids(input);
  std::vector<std::string> objects;
  for (const BodyId id : ids) {
    objects.push_back(object_json(input, shown, id, outline_at, points_of[id], budget.object_points / ids.size()));
  }
  return json_array(objects);
}

std::string true_bodies_json(const ReportInput& input, const ShownFrames& shown) {
  const std::optional<Rigid3> alignment = T_truth_world(input);
  std::vector<std::string> bodies;
  for (const BodyErrors& errors : input.errors.bodies) {
    const auto true_pose = [&](std::size_t frame) {
      return true_body_in_world(input.judged.truth->frames[frame], errors.body, *alignment);
    };
    const std::optional<Eigen::Vector3d> p_body = followed_point(input.judged.run, errors.samples.front(), true_pose);
    JsonNumbers frames(0), positions(kPoseDecimals);
    for (std::size_t i = 0; i < shown.frames.size(); ++i) {
      const std::optional<Rigid3> T_world_body = true_pose(shown.frames[i]);
      if (!T_world_body || !p_body) continue;
      frames.add(static_cast<double>(i));
      positions.add(Eigen::Vector3d(*T_world_body * *p_body));
    }
    bodies.push_back(JsonObject()
                         .text("name", body_name(input, errors))
                         .text("color", css_color(object_color(errors.samples.front().object)))
                         .raw("frame", frames.str())
                         .raw("p", positions.str())
                         .str());
  }
  return json_array(bodies);
}

std::string static_points_json(const ReportInput& input, const PageBudget& budget) {
  std::vector<ScenePoint> points;
  for (const ScenePoint& point : input.points) {
    if (point.body == kWorldBody) points.push_back(point);
  }
  const ViewAxes axes = view_axes(input.judged.run, points);
  const std::size_t total = points.size();
  points = thinned(points, budget.static_points);
  JsonNumbers coordinates(kPointDecimals), gray(0), rotation(9);
  for (const ScenePoint& point : points) {
    coordinates.add(point.p_body);
    gray.add(point.gray);
  }
  for (int row = 0; row < 3; ++row) rotation.add(Eigen::Vector3d(axes.R_view_world.row(row)));
  return JsonObject()
      .raw("R_view_world", rotation.str())
      .flag("up_from_plane", axes.from_plane)
      .text("color", css_color(kStaticColor))
      .raw("points", coordinates.str())
      .raw("gray", gray.str())
      .integer("points_total", static_cast<long long>(total))
      .str();
}

}  // namespace pelorus
