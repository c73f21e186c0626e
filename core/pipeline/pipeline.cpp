#include "core/pipeline/pipeline.h"

namespace pelorus {

struct Pipeline::State {
  FrameResult result;
};

Pipeline::Pipeline(const PipelineConfig&, const StereoRig&) : state_(std::make_unique<State>()) {}
Pipeline::~Pipeline() = default;

const FrameResult& Pipeline::step(const StereoFrame& frame) {
  state_->result.seq = frame.seq;
  state_->result.capture_time = frame.capture_time;
  return state_->result;
}

std::span<const PointView> Pipeline::points() const { return {}; }

}  // namespace pelorus
