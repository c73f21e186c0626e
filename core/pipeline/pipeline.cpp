#include "core/pipeline/pipeline.h"

#include "core/base/stage_timer.h"
#include "core/pipeline/state.h"

namespace pelorus {

Pipeline::Pipeline(const PipelineConfig& config, const StereoRig& rig, const PipelineWorkers& workers)
    : state_(std::make_unique<State>(config, rig, workers)) {}
Pipeline::~Pipeline() = default;

// The computation procedure of one step (paper 6.1, 6.2 and Fig. 6).
const FrameResult& Pipeline::step(const StereoFrame& frame, Shed shed) {
  State& s = *state_;
  s.begin(frame, shed);
  FrameReport& report = s.result.report;
  const StageTimer step_timer(report.step_microseconds);
  {
    const StageTimer timer(report[Stage::front_end].microseconds);
    s.match_points(frame);
  }
  {
    const StageTimer timer(report[Stage::partition].microseconds);
    s.measure_noise();
    s.partition_coarsely();
  }
  {
    const StageTimer timer(report[Stage::ego_motion].microseconds);
    s.find_world();
    s.split_static_from_moving();
  }
  {
    const StageTimer timer(report[Stage::static_filters].microseconds);
    s.filter_static_and_moving();
  }
  {
    const StageTimer timer(report[Stage::static_window].microseconds);
    s.refine_ego_motion();
  }
  {
    const StageTimer timer(report[Stage::objects].microseconds);
    s.follow_bodies();
    s.find_new_bodies();
    s.settle_bodies();
  }
  {
    const StageTimer timer(report[Stage::refill].microseconds);
    s.start_points();
  }
  {
    const StageTimer timer(report[Stage::static_window].microseconds);
    s.give_to_window();
  }
  s.publish();
  return s.result;
}

std::span<const PointView> Pipeline::points() const { return state_->views; }

}  // namespace pelorus
