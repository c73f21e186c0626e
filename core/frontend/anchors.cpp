// FrontEnd's anchors: the kept reference images against which places are refined, and the slopes of the surfaces that
// their patches lie on. Part of FrontEnd (front_end.h).

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/frontend/front_end.h"
#include "core/frontend/warp.h"

namespace pelorus {

// Against the kept image the error of a place does not add up over frames; agreement of the two searches is also
// the stronger check, so that these points need no backward pass.
void FrontEnd::refine_by_reference() {
  for (std::size_t slot = 0; slot < images_.left.size(); ++slot) {
    if (!images_.is_reference[slot]) continue;
    work_tasks_.clear();
    work_of_.clear();
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      const Track& track = tracks_[t];
      const KltTask& step = left_tasks_[t];
      if (track.reference != static_cast<int>(slot) || step.outcome != KltOutcome::ok) continue;
      KltTask task = task_between(track.u_reference_px, track.v_reference_px, step.u_to_px, step.v_to_px);
      task.warp = compose_warp(step.warp, track.warp);
      work_tasks_.push_back(task);
      work_of_.push_back(t);
    }
    if (work_tasks_.empty()) {
      images_.is_reference[slot] = false;
      continue;
    }
    track(work_tasks_, images_.left[slot], images_.current(), KltSearch::plane, 0);
    for (std::size_t w = 0; w < work_tasks_.size(); ++w) {
      KltTask& step = left_tasks_[work_of_[w]];
      const KltTask& refined = work_tasks_[w];
      const double moved_px = std::hypot(static_cast<double>(refined.u_to_px - step.u_to_px),
                                         static_cast<double>(refined.v_to_px - step.v_to_px));
      const bool agrees = refined.outcome == KltOutcome::ok && refined.level == 0 &&
                          static_cast<double>(refined.ncc) >= config_.reference_min_ncc &&
                          moved_px < config_.reference_agreement_px;
      if (!agrees) {
        tracks_[work_of_[w]].reference = -1;  // anchored anew at the next reference image
        continue;
      }
      step.u_to_px = refined.u_to_px;
      step.v_to_px = refined.v_to_px;
      step.ncc = refined.ncc;
    }
  }
}

// The slope of the surface around each point, from the disparities of its nearest neighbours on the same body: a
// patch on a slanted sea floor is sheared by the vehicle's motion, and a tracker that does not know it drifts.
void FrontEnd::measure_slopes() {
  const double radius2 = config_.slope_radius_px * config_.slope_radius_px;
  by_column_.clear();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Track& track = tracks_[track_of_pair_[i]];
    by_column_.push_back({track.latest.z_px.head<2>(), track.latest.z_px.x() - track.latest.z_px.z(), track.body, i});
  }
  // Neighbours lie in a strip of columns then.
  std::sort(by_column_.begin(), by_column_.end(), [](const SlopePoint& a, const SlopePoint& b) {
    return a.px.x() != b.px.x() ? a.px.x() < b.px.x() : a.pair < b.pair;
  });
  auto first = by_column_.cbegin();
  for (const SlopePoint& point : by_column_) {
    while (first->px.x() <= point.px.x() - config_.slope_radius_px) ++first;
    Eigen::Matrix2d A = Eigen::Matrix2d::Identity() * 50.0;  // pulls towards "faces the camera" when neighbours are few
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    int count = 0;
    for (auto other = first; other != by_column_.cend(); ++other) {
      const Eigen::Vector2d offset = other->px - point.px;
      if (offset.x() >= config_.slope_radius_px) break;
      const double distance2 = offset.squaredNorm();
      if (distance2 >= radius2 || distance2 < 1.0 || other->body != point.body) continue;
      const double change_px = other->disparity_px - point.disparity_px;
      if (std::abs(change_px) > config_.max_slope * std::sqrt(distance2)) continue;  // across an edge
      const double weight = 1.0 - distance2 / radius2;
      A += weight * offset * offset.transpose();
      b += weight * offset * change_px;
      ++count;
    }
    // Else as the stereo match of its birth told.
    if (count >= 3) tracks_[track_of_pair_[point.pair]].disparity_gradient = A.inverse() * b;
  }
}

// Every few frames the current left image is kept and points without an anchor take it as theirs.
void FrontEnd::renew_references() {
  if (frames_ > 1 && ++frames_since_reference_ < config_.reference_spacing) return;
  frames_since_reference_ = 0;
  images_.is_reference[static_cast<std::size_t>(images_.curr)] = true;
  for (Track& track : tracks_) {
    if (track.reference >= 0) continue;
    track.reference = images_.curr;
    track.u_reference_px = static_cast<float>(track.latest.z_px.x());
    track.v_reference_px = static_cast<float>(track.latest.z_px.y());
    track.warp = {1, 0, 0, 1};
  }
}

// A slot that neither the previous frame nor a reference holds; the reference with the fewest points gives way.
int FrontEnd::free_slot() {
  const auto slots = static_cast<int>(images_.left.size());
  int fewest_slot = -1;
  std::ptrdiff_t fewest = 0;
  for (int s = 0; s < slots; ++s) {
    if (s == images_.prev) continue;
    if (!images_.is_reference[static_cast<std::size_t>(s)]) return s;
    const auto users = std::count_if(tracks_.begin(), tracks_.end(), [s](const Track& t) { return t.reference == s; });
    if (fewest_slot < 0 || users < fewest) {
      fewest_slot = s;
      fewest = users;
    }
  }
  for (Track& track : tracks_) {
    if (track.reference == fewest_slot) track.reference = -1;
  }
  images_.is_reference[static_cast<std::size_t>(fewest_slot)] = false;
  return fewest_slot;
}

}  // namespace pelorus
