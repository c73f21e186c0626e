// FrontEnd::refill: where points are started. Part of FrontEnd (front_end.h), apart from carrying them.

#include <algorithm>
#include <cmath>

#include "core/frontend/front_end.h"

namespace pelorus {
namespace {

bool inside_area(const RefillArea& area, const SurfPoint& point) {
  // Convex outline, either winding: the point is on one side of all edges.
  int left = 0;
  int right = 0;
  for (int k = 0; k < area.outline_size; ++k) {
    const OutlinePoint& a = area.outline[static_cast<std::size_t>(k)];
    const OutlinePoint& b = area.outline[static_cast<std::size_t>((k + 1) % area.outline_size)];
    const float cross = (b.u_px - a.u_px) * (point.v_px - a.v_px) - (b.v_px - a.v_px) * (point.u_px - a.u_px);
    left += cross > 0;
    right += cross < 0;
  }
  return area.outline_size >= 3 && (left == 0 || right == 0);
}

}  // namespace

bool FrontEnd::wants_refill() const {
  return tracks_.empty() || static_cast<double>(tracks_.size()) < config_.refill_below * config_.max_points ||
         frames_since_refill_ >= config_.refill_every;
}

void FrontEnd::refill(std::span<const RefillArea> areas, bool force) {
  if (force || will_refill_ || (may_refill_ && wants_refill())) {
    counts_.refilled = true;
    frames_since_refill_ = 0;
    detect();
    workers_.surf.wait();
    choose_starts(areas);
    start_points();
  }
  workers_.surf.wait();  // the image goes with the step
}

// Strongest points first, where a cell of the view has fewer than its share; bodies get more and denser points.
void FrontEnd::choose_starts(std::span<const RefillArea> areas) {
  starts_.clear();
  const auto cells = static_cast<std::size_t>(config_.cell_columns * config_.cell_rows);
  std::vector<int>& in_cell = cell_counts_;
  in_cell.assign(cells, 0);
  const auto cell_of = [&](double u, double v) {
    const int column = std::clamp(static_cast<int>(u * config_.cell_columns / rig_.width), 0, config_.cell_columns - 1);
    const int row = std::clamp(static_cast<int>(v * config_.cell_rows / rig_.height), 0, config_.cell_rows - 1);
    return static_cast<std::size_t>(row * config_.cell_columns + column);
  };
  for (const Track& track : tracks_) ++in_cell[cell_of(track.latest.z_px.x(), track.latest.z_px.y())];
  int object_points = 0;
  area_counts_.clear();
  for (const RefillArea& area : areas) {
    area_counts_.push_back(area.points_inside);
    object_points += area.points_inside;
  }
  const int per_cell = std::max(1, config_.max_points / static_cast<int>(cells) + 1);
  const auto too_near = [&](const SurfPoint& p, double distance_px) {
    const double d2 = distance_px * distance_px;
    const auto near = [&](double u, double v) {
      const double du = static_cast<double>(p.u_px) - u;
      const double dv = static_cast<double>(p.v_px) - v;
      return du * du + dv * dv < d2;
    };
    return std::any_of(tracks_.begin(), tracks_.end(),
                       [&](const Track& t) { return near(t.latest.z_px.x(), t.latest.z_px.y()); }) ||
           std::any_of(starts_.begin(), starts_.end(), [&](const SurfPoint& s) {
             return near(static_cast<double>(s.u_px), static_cast<double>(s.v_px));
           });
  };
  const auto room = static_cast<std::size_t>(std::max(0, config_.max_points - static_cast<int>(tracks_.size())));
  for (const SurfPoint& point : detected_points_) {
    if (starts_.size() >= room) break;
    std::size_t area = 0;
    while (area < areas.size() && !inside_area(areas[area], point)) ++area;
    const std::size_t cell = cell_of(static_cast<double>(point.u_px), static_cast<double>(point.v_px));
    if (area < areas.size()) {
      if (area_counts_[area] >= config_.max_points_per_object) continue;
      if (too_near(point, config_.min_distance_object_px)) continue;
      ++area_counts_[area];
    } else {
      if (in_cell[cell] >= per_cell || too_near(point, config_.min_distance_px)) continue;
      ++in_cell[cell];
    }
    starts_.push_back(point);
  }
}

void FrontEnd::start_points() {
  stereo_tasks_.clear();
  for (const SurfPoint& point : starts_) {
    StereoTask task{};
    task.u_left_px = point.u_px;
    task.v_px = point.v_px;
    stereo_tasks_.push_back(task);
  }
  descriptors_.resize(starts_.size());
  workers_.surf.start(work_of<&FrontEnd::describe_starts>(*this));
  const std::size_t half = stereo_tasks_.size() / 2;
  share_.stereo_tasks = std::span(stereo_tasks_).first(half);
  workers_.tracking.start(work_of<&FrontEnd::match_share>(*this));
  stereo_.match(images_.current(), images_.right, std::span(stereo_tasks_).subspan(half));
  workers_.tracking.wait();
  workers_.surf.wait();
  for (std::size_t s = 0; s < starts_.size(); ++s) {
    const StereoTask& match = stereo_tasks_[s];
    const double disparity_px = static_cast<double>(match.u_left_px - match.u_right_px);
    if (match.outcome != StereoOutcome::ok || disparity_px < config_.min_disparity_px) continue;
    Track track;
    track.id = TrackId{next_track_++};
    track.latest.z_px = {static_cast<double>(match.u_left_px), static_cast<double>(match.v_px),
                         static_cast<double>(match.u_right_px)};
    track.latest.p_cam = rig_.triangulate(track.latest.z_px);
    track.match_error = 1.0 - static_cast<double>(match.ncc);
    track.disparity_gradient = {1.0 - static_cast<double>(match.warp[0]), -static_cast<double>(match.warp[1])};
    track.descriptor = descriptors_[s];
    track.laplacian = starts_[s].laplacian;
    track.has_descriptor = true;
    tracks_.push_back(track);
    ++counts_.started;
  }
}

}  // namespace pelorus
