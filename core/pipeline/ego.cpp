// Steps of the pipeline that concern the static scene and the vehicle's own motion.

#include <algorithm>
#include <cmath>

#include "core/motion/stereo_transfer.h"
#include "core/pipeline/state.h"

namespace pelorus {
namespace {

// Of at least one value; changes their order.
double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void Pipeline::State::begin(const StereoFrame& frame, Shed what_to_shed) {
  shed = what_to_shed;
  result = FrameResult{};
  result.report.shed = shed;
  result.seq = frame.seq;
  result.capture_time = frame.capture_time;
  result.reset_counter = reset_counter;
  ego_outcome = StageOutcome::not_run;
  world = WorldStep{};
  world.time = frame.capture_time;
  world.seed = steps++;
  if (started) {
    world.dt_s = std::max(1e-4, seconds(frame.capture_time - last_time));
    result.report.frames_missed = static_cast<std::int32_t>(frame.seq - last_seq) - 1;
  }
  world.T_world_prev = T_world_cam;
  // Constant velocity over the true time between frames, so that a gap of a few frames is predicted as such.
  world.T_world_curr = twist_known ? T_world_cam * se3_exp(twist_cam * world.dt_s) : T_world_cam;
  registry.predict(world.T_world_prev, world.T_world_curr, world.dt_s);
  predictions.clear();
  const bool predict = config.steps.motion_prediction;
  predictions.push_back(
      {kWorldBody, predict ? Rigid3(world.T_world_curr.inverse() * world.T_world_prev) : Rigid3::Identity()});
  for (const MovingBody& body : registry.bodies()) {
    predictions.push_back({body.id, predict ? body.H_curr_prev : Rigid3::Identity()});
  }
  last_time = frame.capture_time;
  last_seq = frame.seq;
}

void Pipeline::State::match_points(const StereoFrame& frame) {
  front_end.set_sigma(sigma_px);
  pairs = front_end.run(frame, predictions, shed < Shed::refill);
  track_of_pair.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    track_of_pair.push_back(&front_end.track_of_pair(static_cast<PointIndex>(i)));
  }
  roles.assign(pairs.size(), PointRole::unknown);
  chi2_static.assign(pairs.size(), 0.0);
  owner.assign(pairs.size(), kNoBody);
  result.report.points_tracked = static_cast<std::int32_t>(pairs.size());
  result.report[Stage::front_end].outcome = pairs.empty() ? StageOutcome::too_few_points : StageOutcome::ok;
}

// Ego motion and known bodies compete with the groups that rigidity proposes, on equal terms.
void Pipeline::State::partition_coarsely() {
  if (!started) return;
  open.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) open[i] = static_cast<PointIndex>(i);
  std::array<Rigid3, kMaxObjects + 1> priors;
  std::size_t count = 0;
  for (const BodyPrediction& p : predictions) {
    if (count < priors.size()) priors[count++] = p.H_curr_prev;
  }
  const Grouping::Options options{config.steps.rigidity_grouping, config.steps.motion_reassignment};
  coarse = &grouping.run(rig, pairs, open, {priors.data(), count}, world.seed, options);
  result.report.groups = static_cast<std::int32_t>(coarse->groups.size());
  result.report[Stage::partition].outcome = coarse->groups.empty() ? StageOutcome::no_agreement : StageOutcome::ok;
}

void Pipeline::State::find_world() {
  if (!started) return;
  std::optional<Rigid3> H_predicted;
  if (twist_known) H_predicted = predictions.front().H_curr_prev;
  const StaticChoice choice =
      choose_static_group(rig, pairs, *coarse, H_predicted, config.static_group, config.steps.static_criteria);
  world_confidence = choice.world_confidence;
  if (choice.group < 0) {
    ego_outcome = StageOutcome::no_agreement;
    return;
  }
  const Group& group = coarse->groups[static_cast<std::size_t>(choice.group)];
  if (static_cast<int>(group.members.size()) < config.ego_motion.min_static_points) {
    ego_outcome = StageOutcome::too_few_points;
    return;
  }
  for (const PointIndex i : group.members) roles[static_cast<std::size_t>(i)] = PointRole::fixed;
  collect_fixed();
  ego = two_frame_ba.run(rig, pairs, fixed, group.H_curr_prev);
  ego_outcome = ego.outcome == StageOutcome::not_converged ? StageOutcome::ok : ego.outcome;
}

void Pipeline::State::split_static_from_moving() {
  if (!ego_found()) return;
  StaticMotions motions = static_motions;
  for (int j = std::min(motions.size, kPastFrames); j > 0; --j) {
    motions.T_curr_past[static_cast<std::size_t>(j)] =
        ego.H_curr_prev * motions.T_curr_past[static_cast<std::size_t>(j - 1)];
  }
  motions.T_curr_past[0] = ego.H_curr_prev;
  motions.size = std::min(motions.size + 1, kPastFrames + 1);
  if (config.steps.repartition) {
    repartition(rig, pairs, motions, config.repartition, roles, chi2_static);
  } else {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      chi2_static[i] = static_chi2(rig, pairs[i], motions);
      if (roles[i] == PointRole::unknown) roles[i] = PointRole::moving;
    }
  }
  static_motions = motions;
  collect_fixed();
}

// The points that carry the ego motion. A known body at rest moves with the world until it sets off, slowly: its points
// would drag the world along before they can be told apart, so they carry nothing as long as others can.
void Pipeline::State::collect_fixed() {
  fixed.clear();
  std::size_t all = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (roles[i] != PointRole::fixed) continue;
    ++all;
    if (!registry.is_confirmed(pairs[i].previous_body)) fixed.push_back(static_cast<PointIndex>(i));
  }
  const auto enough = std::max(all / 2, static_cast<std::size_t>(config.ego_motion.min_static_points));
  if (fixed.size() >= enough) return;
  fixed.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (roles[i] == PointRole::fixed) fixed.push_back(static_cast<PointIndex>(i));
  }
}

// Of the fixed points, from the motion known so far, which stays when they do not tell.
void Pipeline::State::fit_ego_motion() {
  const MotionFit fit = two_frame_ba.run(rig, pairs, fixed, ego.H_curr_prev);
  if (fit.outcome != StageOutcome::degenerate) ego = fit;
}

// The static motion is estimated anew after each filter (6.1 step 6); suspects are then tested against it, and those
// that fit have their say in it again: among scattered false motion (snow, dim water) every third point is suspect.
void Pipeline::State::filter_static_and_moving() {
  if (!ego_found()) return;
  net.build(pairs, roles);
  if (config.steps.net_filter && net_filter(net, pairs, roles) > 0) collect_fixed();
  if (static_cast<int>(fixed.size()) < config.ego_motion.min_static_points) {
    ego_outcome = StageOutcome::too_few_points;
    result.report[Stage::static_filters].outcome = ego_outcome;
    return;
  }
  const bool filters = config.steps.net_filter || config.steps.ray_filter;
  result.report[Stage::static_filters].outcome = filters ? StageOutcome::ok : StageOutcome::not_run;
  fit_ego_motion();
  if (config.steps.ray_filter) {
    (void)ray_filter(rig, net, pairs, chi2_static, config.ray_filter, roles);
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (roles[i] != PointRole::suspect) continue;
    const bool fits = transfer_chi2(rig, ego.H_curr_prev, pairs[i]) < config.repartition.return_chi2;
    roles[i] = fits && pairs[i].previous_body <= kWorldBody ? PointRole::fixed : PointRole::outlier;
  }
  collect_fixed();
  fit_ego_motion();
  static_motions.T_curr_past[0] = ego.H_curr_prev;
  learn_sigma(config.ego_motion.sigma_learning_rate);
}

// The median residual tells the pixel deviation (the median of 3 degrees of freedom is 2.366). Of all points that no
// body owns, not of the static ones only: those were chosen by this very deviation, and would shrink it for ever.
void Pipeline::State::learn_sigma(double rate) {
  residuals.clear();
  for (const PointPair& pair : pairs) {
    if (pair.previous_body <= kWorldBody) residuals.push_back(transfer_chi2(rig, ego.H_curr_prev, pair));
  }
  if (residuals.size() < 20) return;
  const double measured_px = sigma_px * std::sqrt(median_of(residuals) / 2.366);
  const EgoMotionConfig& c = config.ego_motion;
  sigma_px = std::clamp(sigma_px + rate * (measured_px - sigma_px), c.min_sigma_px, c.max_sigma_px);
}

// The first step of all has only an assumed deviation: it is taken once to measure it, then in earnest.
void Pipeline::State::measure_noise() {
  if (!started || noise_known) return;
  partition_coarsely();
  find_world();
  if (!ego_found()) return;
  learn_sigma(1.0);
  noise_known = true;
  front_end.set_sigma(sigma_px);
  std::fill(roles.begin(), roles.end(), PointRole::unknown);
}

// Step by step, and drawn towards where the window saw the camera in a frame before: the first has the smaller noise
// from frame to frame, the second drifts less.
void Pipeline::State::refine_ego_motion() {
  if (!started) return;
  if (!ego_found()) {
    lose_track();
    return;
  }
  T_world_cam = T_world_cam * ego.H_curr_prev.inverse();
  H_since_given = ego.H_curr_prev * H_since_given;
  if (config.steps.static_window) draw_towards_window();
  T_world_cam = orthonormalized(T_world_cam);
  world.T_world_curr = T_world_cam;
  // The previous pose is corrected alike: bodies are carried from there.
  world.T_world_prev = T_world_cam * ego.H_curr_prev;
  world.cov_H_static = ego.cov_H;
  cov_T_world_cam += transported(T_world_cam, ego.cov_H);
  if (lost) {
    // The way gone unseen is not known better than that the vehicle went on as it did.
    const double lost_s = seconds(world.time - lost_since);
    cov_T_world_cam.topLeftCorner<3, 3>().diagonal().array() += std::pow(lost_s * lost_twist.head<3>().norm(), 2);
    cov_T_world_cam.bottomRightCorner<3, 3>().diagonal().array() += std::pow(lost_s * lost_twist.tail<3>().norm(), 2);
  }
  const Vector6d twist = se3_log(ego.H_curr_prev.inverse()) / world.dt_s;
  twist_cam = twist_known ? Vector6d(twist_cam + 0.7 * (twist - twist_cam)) : twist;
  twist_known = true;
  lost = false;
}

void Pipeline::State::draw_towards_window() {
  misfits = {};
  StageOutcome outcome = StageOutcome::not_run;
  if (const auto answer = ego_window.collect(workers.wait_for_refine, outcome)) {
    const Vector6d error = se3_log(answer->T_cam_world.inverse() * T_world_cam_given.inverse());
    // Of one frame: more is no drift but a window that went astray. A shift counts as the angle it is seen under.
    depths.clear();
    for (const PointIndex i : fixed) depths.push_back(pairs[static_cast<std::size_t>(i)].curr.p_cam.z());
    const double limit = config.ego_motion.max_window_error_rad;
    if (!depths.empty() && error.head<3>().norm() < limit * median_of(depths) && error.tail<3>().norm() < limit) {
      T_world_cam = se3_exp(config.ego_motion.window_pull * error) * T_world_cam;
      misfits = answer->misfits;
    } else {
      ego_window.forget();
      outcome = StageOutcome::no_agreement;
    }
  }
  result.report[Stage::static_window].outcome = outcome;
}

// The frame goes to the window, whose answer comes with a later one.
void Pipeline::State::give_to_window() {
  if (!started || !ego_found() || !config.steps.static_window) return;
  if (!ego_window.idle()) return;
  observations.clear();
  before.clear();
  for (const PointIndex i : fixed) {
    const PointPair& pair = pairs[static_cast<std::size_t>(i)];
    observations.push_back({pair.track, pair.curr.z_px, pair.sigma_px});
    if (ego_window.is_new()) before.push_back({pair.track, pair.prev.z_px, pair.sigma_px});
  }
  // A new window starts at the frame before this one, whatever went by since the last was given.
  const Rigid3& H_curr_prev = ego_window.is_new() ? ego.H_curr_prev : H_since_given;
  ego_window.give(world.time, world.dt_s, H_curr_prev, world.T_world_prev, before, observations);
  T_world_cam_given = T_world_cam;
  H_since_given = Rigid3::Identity();
}

// Too little to stand on: the result says so; the pose goes on from the last one once points agree again.
void Pipeline::State::lose_track() {
  if (!lost) {
    ++reset_counter;
    cov_T_world_cam *= config.ego_motion.lost_inflation;
    cov_T_world_cam.diagonal().array() += 1e-6;
    lost_since = last_time + Duration(static_cast<std::int64_t>(-world.dt_s * 1e9));
    lost_twist = twist_known ? twist_cam : Vector6d(Vector6d::Zero());
  }
  lost = true;
  twist_known = false;
  ego = MotionFit{};
  world.cov_H_static = Matrix6d::Zero();
  registry.lose();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    BodyId& body = front_end.track_of_pair(static_cast<PointIndex>(i)).body;
    if (body > kWorldBody) body = kNoBody;
  }
  ego_window.forget();
  H_since_given = Rigid3::Identity();
  static_motions.size = 0;
}

}  // namespace pelorus
