#include "core/frontend/front_end.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/frontend/warp.h"

namespace pelorus {
namespace {

constexpr int kPredictedStartLevel = 2;  // a prediction is good to some ten pixels

const Rigid3& motion_of(BodyId body, std::span<const BodyPrediction> motions) {
  for (const BodyPrediction& m : motions) {
    if (m.body == body) return m.H_curr_prev;
  }
  return motions.front().H_curr_prev;
}

bool inside(const StereoRig& rig, double u, double v) {
  return u >= 0 && v >= 0 && u <= rig.width - 1 && v <= rig.height - 1;
}

}  // namespace

FrontEnd::FrontEnd(const FrontEndConfig& config, const StereoRig& rig, const FrontEndWorkers& workers)
    : config_(config),
      rig_(rig),
      workers_(workers),
      klt_(config.klt),
      stereo_(config.stereo, klt_),
      surf_(config.surf, rig.width, rig.height),
      surf_matcher_(config.surf_match),
      images_(rig.width, rig.height, config.klt.levels, config.reference_images) {
  const auto capacity = static_cast<std::size_t>(config.max_points);
  tracks_.reserve(capacity);
  pairs_.reserve(capacity);
  track_of_pair_.reserve(capacity);
  left_tasks_.reserve(capacity);
  work_tasks_.reserve(capacity);
  work_of_.reserve(capacity);
  starts_.reserve(capacity);
  area_counts_.reserve(64);  // of refill areas
  cell_counts_.reserve(static_cast<std::size_t>(config.cell_columns * config.cell_rows));
  by_column_.reserve(capacity);
  lost_points_.reserve(capacity);
  lost_descriptors_.reserve(capacity);
  descriptors_.reserve(static_cast<std::size_t>(config.surf.max_points));
  stereo_tasks_.reserve(capacity);
}

Track& FrontEnd::track_of_pair(PointIndex pair) { return tracks_[track_of_pair_[static_cast<std::size_t>(pair)]]; }

PointPairs FrontEnd::run(const StereoFrame& frame, std::span<const BodyPrediction> predictions, bool may_refill) {
  counts_ = {};
  may_refill_ = may_refill;
  take_images(frame);
  if (frames_++ == 0) return {};
  carry_left(predictions);
  retry_lost();
  if (counts_.lost > (1.0 - config_.bridge_below) * static_cast<double>(tracks_.size())) bridge_by_surf();
  refine_by_reference();
  check_backward();
  carry_right(predictions);
  build_pairs();
  return pairs_;
}

void FrontEnd::take_images(const StereoFrame& frame) {
  frame_ = frame;
  detected_ = false;
  ++frames_since_refill_;
  images_.prev = images_.curr;
  images_.curr = free_slot();
  workers_.tracking.start(work_of<&FrontEnd::build_right>(*this));
  // Detection runs beside the step when it is certain to be wanted at its end: points only get fewer until then.
  will_refill_ = may_refill_ && wants_refill();
  if (will_refill_) detect();
  images_.left[static_cast<std::size_t>(images_.curr)].build(frame.left, config_.klt.levels);
  workers_.tracking.wait();
}

void FrontEnd::build_right() { images_.right.build(frame_.right, config_.klt.levels); }

void FrontEnd::carry_left(std::span<const BodyPrediction> predictions) {
  left_tasks_.clear();
  for (const Track& track : tracks_) {
    const Rigid3& H_curr_prev = motion_of(track.body, predictions);
    const Eigen::Vector3d p_curr = H_curr_prev * track.latest.p_cam;
    Eigen::Vector3d z_px = track.latest.z_px;
    if (p_curr.z() > 0.05) z_px = rig_.project(p_curr);
    if (!inside(rig_, z_px.x(), z_px.y())) z_px = track.latest.z_px;
    KltTask task = task_between(track.latest.z_px.x(), track.latest.z_px.y(), z_px.x(), z_px.y());
    task.warp = step_warp(rig_, H_curr_prev, track.latest.p_cam, track.disparity_gradient);
    left_tasks_.push_back(task);
  }
  track(left_tasks_, images_.previous(), images_.current(), KltSearch::plane, kPredictedStartLevel, true);
}

// Points that the prediction led astray get a second search from where they were, from the coarsest level.
void FrontEnd::retry_lost() {
  work_tasks_.clear();
  work_of_.clear();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (left_tasks_[t].outcome == KltOutcome::ok) continue;
    ++counts_.lost;
    const Eigen::Vector3d& z_px = tracks_[t].latest.z_px;
    work_tasks_.push_back(task_between(z_px.x(), z_px.y(), z_px.x(), z_px.y()));
    work_of_.push_back(t);
  }
  if (work_tasks_.empty()) return;
  track(work_tasks_, images_.previous(), images_.current(), KltSearch::plane, config_.klt.levels - 1);
  for (std::size_t w = 0; w < work_tasks_.size(); ++w) {
    if (work_tasks_[w].outcome != KltOutcome::ok) continue;
    left_tasks_[work_of_[w]] = work_tasks_[w];
    --counts_.lost;
  }
}

// After a loss (large gap, sudden motion) the descriptors that stay with the points find them again (paper 6.1
// step 1); KLT then places them to sub-pixel accuracy, so that one tracker's error model holds for all points.
void FrontEnd::bridge_by_surf() {
  detect();
  workers_.surf.wait();
  const auto strongest = detected_points_.first(
      std::min(detected_points_.size(), static_cast<std::size_t>(std::max(0, config_.bridge_points))));
  descriptors_.resize(strongest.size());
  surf_.describe(strongest, descriptors_);
  work_tasks_.clear();
  work_of_.clear();
  lost_points_.clear();
  lost_descriptors_.clear();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (left_tasks_[t].outcome == KltOutcome::ok || !tracks_[t].has_descriptor) continue;
    const Track& track = tracks_[t];
    lost_points_.push_back({.u_px = static_cast<float>(track.latest.z_px.x()),
                            .v_px = static_cast<float>(track.latest.z_px.y()),
                            .laplacian = track.laplacian});
    lost_descriptors_.push_back(track.descriptor);
    work_of_.push_back(t);
  }
  const auto radius_px = static_cast<float>(config_.bridge_radius_px);
  const auto matches = surf_matcher_.match(lost_points_, lost_descriptors_, strongest, descriptors_, radius_px);
  std::size_t kept = 0;  // matches come ordered by `first`, so work_of_ can be packed in place
  for (const SurfMatch& match : matches) {
    const auto lost = static_cast<std::size_t>(match.first);
    const SurfPoint& found = strongest[static_cast<std::size_t>(match.second)];
    work_tasks_.push_back(task_between(lost_points_[lost].u_px, lost_points_[lost].v_px, found.u_px, found.v_px));
    work_of_[kept++] = work_of_[lost];
  }
  track(work_tasks_, images_.previous(), images_.current(), KltSearch::plane, 1);
  for (std::size_t w = 0; w < work_tasks_.size(); ++w) {
    if (work_tasks_[w].outcome != KltOutcome::ok) continue;
    left_tasks_[work_of_[w]] = work_tasks_[w];
    ++counts_.bridged;
  }
}

void FrontEnd::check_backward() {
  work_tasks_.clear();
  work_of_.clear();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const KltTask& step = left_tasks_[t];
    if (step.outcome != KltOutcome::ok || tracks_[t].reference >= 0) continue;
    KltTask back = task_between(step.u_to_px, step.v_to_px, step.u_from_px, step.v_from_px);
    back.warp = inverse_warp(step.warp);
    work_tasks_.push_back(back);
    work_of_.push_back(t);
  }
  track(work_tasks_, images_.current(), images_.previous(), KltSearch::plane, 0);
  for (std::size_t w = 0; w < work_tasks_.size(); ++w) {
    KltTask& step = left_tasks_[work_of_[w]];
    const double miss_px = std::hypot(static_cast<double>(work_tasks_[w].u_to_px - step.u_from_px),
                                      static_cast<double>(work_tasks_[w].v_to_px - step.v_from_px));
    if (work_tasks_[w].outcome != KltOutcome::ok || miss_px > config_.forward_backward_px) {
      step.outcome = KltOutcome::diverged;
    }
  }
}

// Left(k) -> right(k) along the row, from the disparity that the body's motion predicts.
void FrontEnd::carry_right(std::span<const BodyPrediction> predictions) {
  work_tasks_.clear();
  work_of_.clear();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const KltTask& step = left_tasks_[t];
    if (step.outcome != KltOutcome::ok) continue;
    const StereoPoint& before = tracks_[t].latest;
    const Eigen::Vector3d p_curr = motion_of(tracks_[t].body, predictions) * before.p_cam;
    double disparity_px = before.z_px.x() - before.z_px.z();
    if (p_curr.z() > 0.05) disparity_px = rig_.f_px * rig_.baseline_m / p_curr.z();
    KltTask task =
        task_between(step.u_to_px, step.v_to_px, static_cast<double>(step.u_to_px) - disparity_px, step.v_to_px);
    task.warp = stereo_warp(tracks_[t].disparity_gradient);
    work_tasks_.push_back(task);
    work_of_.push_back(t);
  }
  track(work_tasks_, images_.current(), images_.right, KltSearch::row, 1, true);
  for (std::size_t w = 0; w < work_tasks_.size(); ++w) {
    const KltTask& across = work_tasks_[w];
    KltTask& step = left_tasks_[work_of_[w]];
    const Eigen::Vector3d z_px(step.u_to_px, step.v_to_px, across.u_to_px);
    const double disparity_px = z_px.x() - z_px.z();
    if (across.outcome != KltOutcome::ok || across.level > 0 || disparity_px < config_.min_disparity_px) {
      step.outcome = KltOutcome::low_correlation;
      continue;
    }
    Track& track = tracks_[work_of_[w]];
    std::shift_right(track.past_px.begin(), track.past_px.end(), 1);
    track.past_px[0] = track.latest.z_px;
    track.past_size = std::min(track.past_size + 1, kPastFrames + 1);
    track.latest.z_px = z_px;
    track.latest.p_cam = rig_.triangulate(z_px);
    track.match_error = 1.0 - static_cast<double>(std::min(step.ncc, across.ncc));
    ++track.age;
  }
}

void FrontEnd::build_pairs() {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (left_tasks_[t].outcome != KltOutcome::ok) continue;
    if (kept != t) {
      tracks_[kept] = tracks_[t];
      left_tasks_[kept] = left_tasks_[t];
    }
    ++kept;
  }
  tracks_.resize(kept);
  left_tasks_.resize(kept);
  pairs_.clear();
  track_of_pair_.clear();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Track& track = tracks_[t];
    PointPair pair;
    pair.past.fill(Eigen::Vector3d::Zero());
    pair.track = track.id;
    pair.prev.z_px = track.past_px[0];
    pair.prev.p_cam = rig_.triangulate(track.past_px[0]);
    pair.curr = track.latest;
    pair.sigma_px = track.sigma_px;
    pair.match_error = track.match_error;
    pair.age = track.age;
    pair.previous_body = track.body;
    pair.past_size = track.past_size - 1;
    std::copy_n(track.past_px.begin() + 1, pair.past_size, pair.past.begin());
    pairs_.push_back(pair);
    track_of_pair_.push_back(t);
  }
  counts_.tracked = static_cast<int>(kept);
}

void FrontEnd::settle(std::span<const BodyId> body_of_pair, std::span<const BodyPrediction> motions) {
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    Track& track = tracks_[track_of_pair_[i]];
    track.body = body_of_pair[i];
    if (track.reference < 0) continue;
    track.warp = compose_warp(
        step_warp(rig_, motion_of(track.body, motions), pairs_[i].prev.p_cam, track.disparity_gradient), track.warp);
    if (!usable_warp(track.warp)) track.reference = -1;
  }
  measure_slopes();
  renew_references();
}

void FrontEnd::set_sigma(double sigma_px) {
  for (Track& track : tracks_) track.sigma_px = sigma_px;
  for (PointPair& pair : pairs_) pair.sigma_px = sigma_px;
}

void FrontEnd::drop(std::span<const TrackId> tracks) {
  std::erase_if(tracks_, [&](const Track& t) { return std::find(tracks.begin(), tracks.end(), t.id) != tracks.end(); });
}

}  // namespace pelorus
