#include "core/model/stage_data.h"

namespace pelorus {

const char* to_text(VisionState state) {
  switch (state) {
    case VisionState::init:
      return "INIT";
    case VisionState::tracking:
      return "TRACKING";
    case VisionState::degraded:
      return "DEGRADED";
    case VisionState::lost:
      return "LOST";
    case VisionState::camera_fault:
      return "CAMERA_FAULT";
    case VisionState::calibration_fault:
      return "CALIBRATION_FAULT";
    case VisionState::standby:
      return "STANDBY";
  }
  return "?";
}

const char* to_text(ObjectPhase phase) {
  switch (phase) {
    case ObjectPhase::tentative:
      return "tentative";
    case ObjectPhase::confirmed:
      return "confirmed";
    case ObjectPhase::coasting:
      return "coasting";
    case ObjectPhase::ended:
      return "ended";
  }
  return "?";
}

const char* to_text(StageOutcome outcome) {
  switch (outcome) {
    case StageOutcome::not_run:
      return "not_run";
    case StageOutcome::ok:
      return "ok";
    case StageOutcome::too_few_points:
      return "too_few_points";
    case StageOutcome::no_agreement:
      return "no_agreement";
    case StageOutcome::degenerate:
      return "degenerate";
    case StageOutcome::not_converged:
      return "not_converged";
    case StageOutcome::skipped:
      return "skipped";
  }
  return "?";
}

const char* to_text(Stage stage) {
  switch (stage) {
    case Stage::front_end:
      return "front_end";
    case Stage::partition:
      return "partition";
    case Stage::ego_motion:
      return "ego_motion";
    case Stage::static_filters:
      return "static_filters";
    case Stage::static_window:
      return "static_window";
    case Stage::objects:
      return "objects";
    case Stage::refill:
      return "refill";
    case Stage::count:
      break;
  }
  return "?";
}

}  // namespace pelorus
