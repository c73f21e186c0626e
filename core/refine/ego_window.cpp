#include "core/refine/ego_window.h"

namespace pelorus {
namespace {

constexpr int kMisfitObservations = 4;  // fewer do not tell
constexpr int kFailuresToStartAnew = 5;

}  // namespace

EgoWindow::EgoWindow(const BodyWindowConfig& config, const StereoRig& rig, int max_points, double misfit_chi2,
                     SideWorker& worker)
    : rig_(rig), window_(config), worker_(worker), misfit_chi2_(misfit_chi2) {
  const auto capacity = static_cast<std::size_t>(max_points);
  before_.reserve(capacity);
  now_.reserve(capacity);
  misfits_.reserve(capacity);
}

std::optional<EgoWindow::Answer> EgoWindow::collect(bool wait, StageOutcome& outcome) {
  if (!given_) return std::nullopt;
  if (wait) worker_.wait();
  if (!worker_.done()) return std::nullopt;
  given_ = false;
  if (forgotten_) {
    forgotten_ = false;
    return std::nullopt;
  }
  outcome = worked_;
  if (worked_ != StageOutcome::ok) {
    if (++failures_ >= kFailuresToStartAnew) is_new_ = true;
    return std::nullopt;
  }
  failures_ = 0;
  return Answer{window_.T_cam_body(), misfits_};
}

void EgoWindow::give(Timestamp time, double dt_s, const Rigid3& H_curr_prev, const Rigid3& T_world_cam_prev,
                     std::span<const WindowObservation> before, std::span<const WindowObservation> now) {
  time_ = time;
  dt_s_ = dt_s;
  H_curr_prev_ = H_curr_prev;
  T_world_cam_prev_ = T_world_cam_prev;
  before_.assign(before.begin(), before.end());
  now_.assign(now.begin(), now.end());
  if (is_new_) window_.clear();
  if (is_new_) failures_ = 0;
  is_new_ = false;
  given_ = true;
  worker_.start(work_of<&EgoWindow::work>(*this));
}

void EgoWindow::forget() {
  forgotten_ = given_;
  is_new_ = true;
}

// On the worker's thread.
void EgoWindow::work() {
  if (window_.frames() == 0) {
    const auto dt = Duration(static_cast<std::int64_t>(-dt_s_ * 1e9));
    window_.add_frame(rig_, time_ + dt, T_world_cam_prev_.inverse(), T_world_cam_prev_, before_);
  }
  const Rigid3 T_cam_world = H_curr_prev_ * window_.T_cam_body();
  window_.add_frame(rig_, time_, T_cam_world, T_cam_world.inverse(), now_);
  worked_ = window_.adjust(rig_);
  find_misfits();
}

void EgoWindow::find_misfits() {
  misfits_.clear();
  for (const BodyPoint& point : window_.points()) {
    if (misfits_.size() == misfits_.capacity()) break;
    if (point.observations >= kMisfitObservations && point.chi2_mean > misfit_chi2_) misfits_.push_back(point.track);
  }
  for (const TrackId track : misfits_) window_.remove(track);
}

}  // namespace pelorus
