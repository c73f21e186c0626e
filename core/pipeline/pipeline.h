#pragma once
// Pipeline::step: one stereo frame in, the vehicle's motion and every moving body's motion out; it reads like the
// paper's list of steps (6.1, 6.2). Thread-bound. No heap allocation after warm-up.

#include <memory>
#include <span>

#include "core/base/side_worker.h"
#include "core/model/stage_data.h"
#include "core/pipeline/config.h"

namespace pelorus {

// Threads lent to the step; absent ones: the step does the work itself, with the same result. Borrowed.
struct PipelineWorkers {
  SideWorker* tracking = nullptr;
  SideWorker* surf = nullptr;
  SideWorker* refine = nullptr;
  // Stepped, the window's answer is waited for, so that the same input gives the same bytes; live it never is.
  bool wait_for_refine = true;
};

class Pipeline {
 public:
  Pipeline(const PipelineConfig& config, const StereoRig& rig, const PipelineWorkers& workers = {});
  ~Pipeline();
  // The frame's images must be rectified and of the rig's size, its seq greater than the previous one.
  // The result is valid until the next call.
  const FrameResult& step(const StereoFrame& frame, Shed shed = Shed::nothing);
  // The points of the last step, for pictures and reports.
  [[nodiscard]] std::span<const PointView> points() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelorus
