#include "services/state_machine.h"

namespace pelorus {
namespace {

void settle_invalid(Publication& publication, VisionState state, StateReason reason) {
  publication.result.state = state;
  publication.result.pose_valid = false;
  publication.result.objects_size = 0;
  publication.result.world_confidence = 0;
  publication.step = Duration::zero();
  publication.reason = reason;
}

StateReason minor_reason(const Circumstances& circumstances) {
  if (circumstances.capture.time_jumped) return StateReason::time_jump;
  if (circumstances.pairs_missed > 0) return StateReason::pairs_dropped;
  return StateReason::none;
}

}  // namespace

bool is_usable(const Circumstances& c) {
  return !c.standby && c.calibration_fits && c.pictures && c.capture.repeats == 0;
}

void settle_state(const Circumstances& c, Publication& publication) {
  if (c.standby) return settle_invalid(publication, VisionState::standby, StateReason::commanded);
  if (!c.pictures) return settle_invalid(publication, VisionState::camera_fault, StateReason::no_pictures);
  if (!c.calibration_fits) {
    return settle_invalid(publication, VisionState::calibration_fault, StateReason::calibration);
  }
  if (c.capture.frozen) {
    return settle_invalid(publication, VisionState::camera_fault, StateReason::frozen_pictures);
  }
  if (c.capture.repeats > 0) {
    return settle_invalid(publication, VisionState::degraded, StateReason::repeated_picture);
  }
  FrameResult& result = publication.result;
  switch (result.state) {
    case VisionState::init:
      publication.reason = StateReason::starting;
      return;
    case VisionState::lost:
      // Not cured by waiting, as other losses are: the autopilot, which hears no reason, hears another state.
      if (c.sides_exchanged) {
        return settle_invalid(publication, VisionState::calibration_fault, StateReason::exchanged_sides);
      }
      return settle_invalid(publication, VisionState::lost, StateReason::few_points);
    case VisionState::degraded:
      publication.reason = result.world_ambiguous ? StateReason::ambiguous_world : StateReason::few_points;
      return;
    default:
      publication.reason = minor_reason(c);
      if (publication.reason != StateReason::none) result.state = VisionState::degraded;
  }
}

void settle_late(Publication& publication) {
  publication.deadline_missed = true;
  if (publication.result.state != VisionState::tracking) return;
  publication.result.state = VisionState::degraded;
  publication.reason = StateReason::deadline_missed;
}

}  // namespace pelorus
