// BodyWindow's upkeep: which frames and points are in the window and how much they count. Part of BodyWindow
// (body_window.h).

#include <algorithm>

#include "core/refine/body_window.h"

namespace pelorus {

// A key frame that shares few points with the newest frame anchors nothing; among useful ones the one closest in
// time to its neighbour goes, so that the oldest, which ties the body to its beginning, stays longest.
std::size_t BodyWindow::least_useful_key_frame(std::size_t keys) const {
  constexpr int kMinShared = 8;
  std::size_t worst = 0;
  int worst_shared = kMinShared;
  for (std::size_t k = 0; k < keys; ++k) {
    const std::uint32_t both = newest_bit() | (1u << frames_[k].slot);
    const auto shared = static_cast<int>(
        std::count_if(points_.begin(), points_.end(), [&](const BodyPoint& p) { return (p.seen & both) == both; }));
    if (shared < worst_shared) {
      worst = k;
      worst_shared = shared;
    }
  }
  if (worst_shared < kMinShared) return worst;
  double smallest = 1e30;
  for (std::size_t k = 1; k < keys; ++k) {
    // Gap relative to age: spacing grows with age, as evidence about old poses changes slowly.
    const double gap = static_cast<double>(frames_[k + 1].number - frames_[k - 1].number);
    const double age = static_cast<double>(next_number_ - frames_[k].number);
    if (gap / age < smallest) {
      smallest = gap / age;
      worst = k;
    }
  }
  return worst;
}

void BodyWindow::make_room() {
  const auto recent = static_cast<std::size_t>(config_.recent_frames);
  if (frames_.size() < recent) return;
  const std::size_t leaving = frames_.size() - recent;  // oldest of the recent part
  // It becomes a key frame when it stands far enough from the last one.
  const bool far = leaving == 0 || frames_[leaving].number - frames_[leaving - 1].number >= config_.key_frame_spacing;
  if (!far) {
    drop_frame(leaving);
  } else if (leaving + 1 > static_cast<std::size_t>(config_.key_frames)) {
    drop_frame(least_useful_key_frame(leaving + 1));
  }
}

void BodyWindow::drop_frame(std::size_t index) {
  const std::uint32_t bit = 1u << frames_[index].slot;
  free_slots_ |= bit;
  for (BodyPoint& point : points_) point.seen &= ~bit;
  std::erase_if(points_, [](const BodyPoint& p) { return p.seen == 0; });
  frames_.erase(frames_.begin() + static_cast<std::ptrdiff_t>(index));
}

void BodyWindow::add_frame(const StereoRig& rig, Timestamp time, const Rigid3& T_cam_body, const Rigid3& T_world_cam,
                           std::span<const WindowObservation> observations) {
  make_room();
  Frame frame;
  frame.slot = __builtin_ctz(free_slots_);
  frame.time = time;
  frame.T_cam_body = T_cam_body;
  frame.T_world_cam = T_world_cam;
  frame.number = next_number_++;
  free_slots_ &= ~(1u << frame.slot);
  frames_.push_back(frame);
  const Rigid3 T_body_cam = T_cam_body.inverse();
  for (const WindowObservation& observation : observations) {
    BodyPoint* point = point_of(observation.track);
    if (point == nullptr) continue;
    if (point->seen == 0) point->p_body = T_body_cam * rig.triangulate(observation.z_px);
    point->seen |= newest_bit();
    point->z_px[static_cast<std::size_t>(frame.slot)] = observation.z_px;
    point->sigma_px = observation.sigma_px;
  }
}

// A new one when there is none yet; none when all the room is taken by points that the newest frame sees.
BodyPoint* BodyWindow::point_of(TrackId track) {
  const auto place_of = [&] {
    return std::lower_bound(points_.begin(), points_.end(), track,
                            [](const BodyPoint& p, TrackId t) { return p.track < t; });
  };
  auto place = place_of();
  if (place != points_.end() && place->track == track) return &*place;
  if (points_.size() == points_.capacity()) {
    const auto least = std::min_element(points_.begin(), points_.end(),
                                        [&](const BodyPoint& a, const BodyPoint& b) { return rank(a) < rank(b); });
    if ((least->seen & newest_bit()) != 0u) return nullptr;
    points_.erase(least);
    place = place_of();
  }
  BodyPoint point;
  point.z_px.fill(Eigen::Vector3d::Zero());
  point.track = track;
  return &*points_.insert(place, point);
}

// Longest observed first, those seen now before those not; among equals the track decides: a fixed order.
int BodyWindow::rank(const BodyPoint& point) const {
  return __builtin_popcount(point.seen) + ((point.seen & newest_bit()) != 0u ? kMaxWindowFrames : 0);
}

void BodyWindow::choose_points() {
  std::size_t used = 0;
  int histogram[2 * kMaxWindowFrames + 8] = {};
  for (const BodyPoint& point : points_) histogram[__builtin_popcount(point.seen) >= 2 ? rank(point) : 0]++;
  int threshold = 2 * kMaxWindowFrames + 7;
  for (int sum = 0; threshold > 0; --threshold) {
    sum += histogram[threshold];
    if (sum > config_.max_points) break;
  }
  for (std::size_t i = 0; i < points_.size() && used < static_cast<std::size_t>(config_.max_points); ++i) {
    if (__builtin_popcount(points_[i].seen) < 2 || rank(points_[i]) < threshold) continue;
    blocks_[used++].point = static_cast<int>(i);
  }
  for (std::size_t i = used; i < blocks_.size(); ++i) blocks_[i].point = -1;
}

// A patch seen from elsewhere is another patch by a little: measurements of one point drift apart with the change of
// view, by slope, shading and edges that a plane cannot model. Frames count the less the further their view is from
// the newest; for a vehicle or body at rest all count fully, which is what holds it without drift.
void BodyWindow::weigh_frames() {
  const Frame& newest = frames_.back();
  double depth_sum_m = 1e-9;
  int depths = 0;
  for (const BodyPoint& point : points_) {
    if ((point.seen & newest_bit()) == 0u) continue;
    depth_sum_m += (newest.T_cam_body * point.p_body).z();
    ++depths;
  }
  const double depth_m = std::max(0.1, depth_sum_m / std::max(1, depths));
  // The change of view is that of the camera about the body.
  for (Frame& frame : frames_) {
    const Rigid3 T_frame_newest = frame.T_cam_body * newest.T_cam_body.inverse();
    const Eigen::Vector3d p_ahead(0, 0, depth_m);
    const double angle_rad = rotation_angle_rad(T_frame_newest.linear());
    const double shift = (T_frame_newest * p_ahead - p_ahead).norm() / depth_m;
    const double change = (angle_rad + shift) / config_.view_change_rad;
    frame.weight = 1.0 / (1.0 + change * change);
  }
}

}  // namespace pelorus
