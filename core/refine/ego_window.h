#pragma once
// Refinement of the vehicle's own motion over recent frames and key frames, in the background (method section 6): a
// frame is given, its answer is collected with a later frame and draws the pose towards where the window sees the
// camera. The step itself never needs it, so that it is never waited for when the vehicle is under way.
// One thread gives and collects; the window works on the worker's. No heap after warm-up.

#include <optional>

#include "core/base/side_worker.h"
#include "core/refine/body_window.h"

namespace pelorus {

class EgoWindow {
 public:
  struct Answer {
    Rigid3 T_cam_world = Rigid3::Identity();  // of the frame given
    std::span<const TrackId> misfits;         // points that the window finds not to be at rest; valid until give()
  };

  // `worker` is borrowed. `misfit_chi2`: mean over a point's observations above which it is not at rest.
  EgoWindow(const BodyWindowConfig& config, const StereoRig& rig, int max_points, double misfit_chi2,
            SideWorker& worker);
  ~EgoWindow() { worker_.wait(); }
  EgoWindow(const EgoWindow&) = delete;
  EgoWindow& operator=(const EgoWindow&) = delete;

  // What has become of the frame given last, once; nothing while the worker is at it (never, with `wait`) or when the
  // window could not be solved. `outcome` is set when something was collected. A window that cannot be solved some
  // times in a row starts anew.
  [[nodiscard]] std::optional<Answer> collect(bool wait, StageOutcome& outcome);
  // Whether a frame can be given.
  [[nodiscard]] bool idle() const { return !given_; }

  // The first frame of a window needs the one before it too: `before` are its observations of the same points.
  // H_curr_prev: camera motion since the frame given before. T_world_cam_prev: anchors a new window.
  void give(Timestamp time, double dt_s, const Rigid3& H_curr_prev, const Rigid3& T_world_cam_prev,
            std::span<const WindowObservation> before, std::span<const WindowObservation> now);
  [[nodiscard]] bool is_new() const { return is_new_; }
  // Track was lost: the window starts anew. What is being worked on is not collected.
  void forget();

 private:
  void work();
  void find_misfits();

  StereoRig rig_;
  BodyWindow window_;
  SideWorker& worker_;
  double misfit_chi2_;
  bool given_ = false;      // and not collected
  bool forgotten_ = false;  // what is being worked on is of no use
  bool is_new_ = true;
  int failures_ = 0;  // in a row
  // The frame being worked on.
  Timestamp time_;
  double dt_s_ = 0;
  Rigid3 H_curr_prev_ = Rigid3::Identity();
  Rigid3 T_world_cam_prev_ = Rigid3::Identity();
  std::vector<WindowObservation> before_;
  std::vector<WindowObservation> now_;
  std::vector<TrackId> misfits_;
  StageOutcome worked_ = StageOutcome::not_run;  // the worker's until it is done
};

}  // namespace pelorus
