#pragma once
// Pipeline::step: one stereo frame in, the vehicle's motion and every moving body's motion out; it reads like the
// paper's list of steps (6.1, 6.2). Thread-bound. No heap allocation after warm-up.

#include <memory>
#include <span>

#include "core/model/stage_data.h"
#include "core/pipeline/config.h"

namespace pelorus {

class Pipeline {
 public:
  Pipeline(const PipelineConfig& config, const StereoRig& rig);
  ~Pipeline();
  // The frame's images must be rectified and of the rig's size, its seq greater than the previous one.
  // The result is valid until the next call.
  const FrameResult& step(const StereoFrame& frame);
  // The points of the last step, for pictures and reports.
  [[nodiscard]] std::span<const PointView> points() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelorus
