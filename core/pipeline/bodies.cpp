// Steps of the pipeline that concern moving bodies, new points and the result.

#include <algorithm>

#include "core/base/check.h"
#include "core/geometry/hull.h"
#include "core/pipeline/state.h"

namespace pelorus {
namespace {

PipelineWorkers with_stand_in(PipelineWorkers workers, SideWorker& stand_in) {
  for (SideWorker** worker : {&workers.tracking, &workers.surf, &workers.refine}) {
    if (*worker == nullptr) *worker = &stand_in;
  }
  return workers;
}

// The switch of a step reaches everything that has its motion from it.
PipelineConfig switched(PipelineConfig config) {
  config.two_frame_ba.adjust = config.steps.bundle_adjustment;
  return config;
}

}  // namespace

Pipeline::State::State(const PipelineConfig& c, const StereoRig& r, const PipelineWorkers& w)
    : config(switched(c)),
      rig(r),
      workers(with_stand_in(w, inline_worker)),
      front_end(c.front_end, r, {*workers.tracking, *workers.surf}),
      grouping(c.grouping, c.seed_points, config.two_frame_ba, c.front_end.max_points),
      moving_grouping(c.grouping, c.seed_points, config.two_frame_ba, c.front_end.max_points),
      two_frame_ba(config.two_frame_ba, c.front_end.max_points),
      net(c.front_end.max_points),
      ego_window(c.static_window, r, c.front_end.max_points, c.ego_motion.point_gate_chi2, *workers.refine),
      registry(c.registry, c.membership, c.identity, c.merge, c.reidentification, c.object_window, config.two_frame_ba,
               c.front_end.max_points),
      sigma_px(c.ego_motion.start_sigma_px) {
  const auto points = static_cast<std::size_t>(c.front_end.max_points);
  PELORUS_CHECK(points <= kMaxPoints, "front_end.max_points is over what a step can hold");
  track_of_pair.reserve(points);
  roles.reserve(points);
  chi2_static.reserve(points);
  owner.reserve(points);
  fixed.reserve(points);
  open.reserve(points);
  predictions.reserve(kMaxObjects + 1);
  residuals.reserve(points);
  depths.reserve(points);
  observations.reserve(points);
  before.reserve(points);
  rejected.reserve(points);
  refill_areas.reserve(kMaxObjects);
  outline_points.reserve(std::max(points, static_cast<std::size_t>(c.registry.max_model_points)));
  views.reserve(points);
}

RegistrySteps Pipeline::State::registry_steps() const {
  const MethodSteps& on = config.steps;
  const bool spare = shed < Shed::object_window;
  return {on.hull_membership,        on.identity_mismatch, on.merge_split,
          on.object_window && spare, on.reidentification,  on.reidentification && spare};
}

void Pipeline::State::follow_bodies() {
  if (!started || !ego_found()) return;
  registry.claim(rig, pairs, roles, chi2_static, world, registry_steps(), owner);
}

// The moving points that no known body explains are divided among new groups (6.1 step 7).
void Pipeline::State::find_new_bodies() {
  if (!started || !ego_found()) return;
  open.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (roles[i] == PointRole::moving && owner[i] == kNoBody) open.push_back(static_cast<PointIndex>(i));
  }
  const MethodSteps& on = config.steps;
  const Grouping::Options options{on.rigidity_grouping, on.motion_reassignment};
  const Partition& groups = moving_grouping.run(rig, pairs, open, {}, world.seed + 1, options);
  registry.adopt(rig, pairs, roles, groups, track_of_pair, world, registry_steps(), owner);
}

void Pipeline::State::settle_bodies() {
  if (!started || !ego_found()) return;
  registry.settle(rig, pairs, roles, chi2_static, track_of_pair, world, registry_steps(), owner);
  result.report[Stage::objects].outcome = StageOutcome::ok;
  result.report.births_refused = registry.births_refused();
}

void Pipeline::State::start_points() {
  predictions.clear();
  predictions.push_back({kWorldBody, ego.H_curr_prev});
  for (const MovingBody& body : registry.bodies()) predictions.push_back({body.id, body.H_curr_prev});
  refill_areas.clear();
  if (started && ego_found()) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (owner[i] == kNoBody && roles[i] == PointRole::fixed) owner[i] = kWorldBody;
    }
    if (config.steps.object_refill) choose_refill_areas();
    drop_unexplained();
    front_end.settle(owner, predictions);
    front_end.drop(rejected);
  } else if (!started) {
    front_end.settle({}, predictions);
  }
  front_end.refill(refill_areas, !started || lost);
  result.report.points_started = front_end.counts().started;
  result.report.refilled = front_end.counts().refilled;
  result.report[Stage::refill].outcome = result.report.refilled                ? StageOutcome::ok
                                         : result.report.shed != Shed::nothing ? StageOutcome::skipped
                                                                               : StageOutcome::not_run;
  started = true;
}

// Where more points are wanted: on the bodies in sight, and where a body out of sight is expected back.
void Pipeline::State::choose_refill_areas() {
  for (const MovingBody& body : registry.bodies()) {
    if (!body.measured && (body.phase != ObjectPhase::coasting || !body.place_known)) continue;
    RefillArea area;
    if (body.measured) {
      collect_members_px(body);
      area.points_inside = static_cast<int>(body.members.size());
    } else {
      collect_model_px(body);
    }
    area.outline_size = outline_of(outline_points, 1.25, area.outline);
    refill_areas.push_back(area);
  }
}

// Points that leave the static scene by their record over the window, and points that fit nothing for long.
void Pipeline::State::drop_unexplained() {
  rejected.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Track& track = front_end.track_of_pair(static_cast<PointIndex>(i));
    if (owner[i] == kWorldBody && std::find(misfits.begin(), misfits.end(), track.id) != misfits.end()) {
      owner[i] = kNoBody;
    }
    track.unexplained = owner[i] == kNoBody ? track.unexplained + 1 : 0;
    if (track.unexplained >= config.ego_motion.unexplained_frames) rejected.push_back(track.id);
  }
}

void Pipeline::State::collect_members_px(const MovingBody& body) {
  outline_points.clear();
  for (const PointIndex i : body.members) {
    outline_points.push_back(pairs[static_cast<std::size_t>(i)].curr.z_px.head<2>());
  }
}

// Where the known points of the body would be seen now.
void Pipeline::State::collect_model_px(const MovingBody& body) {
  outline_points.clear();
  for (const ModelPoint& point : body.model) {
    const Eigen::Vector3d p_cam = body.T_cam_obj * point.p_obj;
    if (p_cam.z() > 0.05) outline_points.push_back(rig.project(p_cam).head<2>());
  }
}

int Pipeline::State::outline_of(std::span<const Eigen::Vector2d> points, double grow,
                                std::array<OutlinePoint, 16>& outline) {
  if (points.size() < 3) return 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  std::array<Eigen::Vector2d, 16> hull;
  const int size = convex_outline(points, hull);
  for (int k = 0; k < size; ++k) {
    const Eigen::Vector2d grown = mean + grow * (hull[static_cast<std::size_t>(k)] - mean);
    outline[static_cast<std::size_t>(k)] = {static_cast<float>(grown.x()), static_cast<float>(grown.y())};
  }
  return size;
}

void Pipeline::State::publish_object(const MovingBody& body, ObjectState& object) {
  object.id = body.id;
  object.phase = body.phase;
  object.motion_measured = body.measured;
  object.T_world_obj = body.T_world_obj;
  object.cov_T_world_obj = body.cov_T_world_obj;
  object.M_world = body.M_world;
  object.cov_M_world = body.cov_M_world;
  object.points = static_cast<int>(body.members.size());
  object.first_seen = body.first_seen;
  object.last_seen = body.last_seen;
  object.centroid_world = body.T_world_obj * body.centroid_obj;
  object.extent_m = body.extent_m;
  collect_members_px(body);
  object.outline_size = outline_of(outline_points, 1.0, object.outline);
}

void Pipeline::State::publish() {
  FrameReport& report = result.report;
  report[Stage::ego_motion].outcome = ego_outcome;
  report.sigma_px = sigma_px;
  const bool first = track_of_pair.empty() && ego_outcome == StageOutcome::not_run;
  result.T_world_cam = T_world_cam;
  result.cov_T_world_cam = cov_T_world_cam;
  result.T_curr_prev = ego.H_curr_prev;
  result.cov_T_curr_prev = world.cov_H_static;
  result.world_confidence = world_confidence;
  result.reset_counter = reset_counter;
  result.pose_valid = first || ego_found();
  const EgoMotionConfig& c = config.ego_motion;
  result.world_ambiguous = ego_found() && world_confidence < c.degraded_confidence;
  const bool weak = static_cast<int>(fixed.size()) < c.degraded_static_points || result.world_ambiguous;
  result.state = first          ? VisionState::init
                 : !ego_found() ? VisionState::lost
                 : weak         ? VisionState::degraded
                                : VisionState::tracking;
  result.objects_size = 0;
  for (const MovingBody& body : registry.bodies()) {
    if (lost || !body.place_known) continue;  // where it is in the world is not known
    publish_object(body, result.objects[static_cast<std::size_t>(result.objects_size++)]);
  }
  views.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    views.push_back({pairs[i].track, pairs[i].curr, owner[i], pairs[i].age});
    report.points_static += owner[i] == kWorldBody;
    report.points_moving += owner[i] > kWorldBody;
    report.points_outlier += owner[i] == kNoBody;
  }
}

}  // namespace pelorus
