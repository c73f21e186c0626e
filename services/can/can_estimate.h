#pragma once
// What one CAN estimate says, in SI units, before it is scaled into frames and after it is read back: the fields of
// the contract (can_contract.h points into this struct) and the conversion from a FrameResult to the vehicle's axes.
// Frames: `body` x forward, y starboard, z down; `start` = the body axes at the first accepted frame. NaN = not known.
// Pure; no allocation.

#include <cstdint>
#include <limits>

#include "core/base/time.h"
#include "core/geometry/transform.h"
#include "services/body_estimate.h"
#include "services/publisher.h"

namespace pelorus {

inline constexpr double kCanUnknown = std::numeric_limits<double>::quiet_NaN();

// Scalars only, so that one row of the contract is one member. Units in the names; signs in the contract.
struct CanEstimate {
  VisionState state = VisionState::init;
  double vel_x_mps = kCanUnknown, vel_y_mps = kCanUnknown,
         vel_z_mps = kCanUnknown;                                                 // of the body origin, along body axes
  double roll_rad = kCanUnknown, pitch_rad = kCanUnknown, yaw_rad = kCanUnknown;  // of R_start_body
  double step_x_m = kCanUnknown, step_y_m = kCanUnknown,
         step_z_m = kCanUnknown;  // p_prev_curr, axes of the body at prev
  double turn_x_rad = kCanUnknown, turn_y_rad = kCanUnknown,
         turn_z_rad = kCanUnknown;  // rotation vector of R_prev_curr
  double step_var_x_mm2 = kCanUnknown, step_var_y_mm2 = kCanUnknown, step_var_z_mm2 = kCanUnknown;
  double turn_var_x_mrad2 = kCanUnknown, turn_var_y_mrad2 = kCanUnknown, turn_var_z_mrad2 = kCanUnknown;
  double position_x_m = kCanUnknown, position_y_m = kCanUnknown, position_z_m = kCanUnknown;  // p_start_body
  double interval_s = kCanUnknown;  // between the measurement before and this one
  double age_s = kCanUnknown;       // from mid-exposure to the moment of encoding
  double latency_s = kCanUnknown;   // the declared one
  double quality_percent = kCanUnknown;
  double resets = 0;
  double sigma_vel_mps = kCanUnknown;  // one standard deviation along the worst axis
  double sigma_att_rad = kCanUnknown;
  double sigma_step_m = kCanUnknown;
  double sigma_position_m = kCanUnknown;
  double bodies = kCanUnknown;  // moving bodies tracked now
  // The nearest of them, seen from the body origin.
  double object_bearing_rad = kCanUnknown, object_elevation_rad = kCanUnknown, object_range_m = kCanUnknown;
  double object_closing_mps = kCanUnknown;
  double object_confidence_percent = kCanUnknown;
  double object_id = kCanUnknown;  // BodyId modulo 255
  double object_points = kCanUnknown;
  double object_phase = kCanUnknown;  // 1 seen now, 2 coasting
  double calibration_hash = 0;        // 32 bits
  double contract_version = 0;
  double sets_dropped = 0;
};

// The last estimate that was sent with a pose.
struct PreviousPose {
  bool known = false;
  Timestamp capture_time;
  int reset_counter = 0;
  Rigid3 T_world_cam = Rigid3::Identity();
};

// Motion, pose and nearest body in the vehicle's axes; the same numbers as VIS_ODOM (services/body_estimate.h). The age
// counts to `now`, of the capture clock; unknown when negative. Velocity is the constant twist of the last frame
// interval. The step is that of the pipeline when `previous` is where it began; after results that were never sent it
// is the difference of the two poses, with a variance that grows with the time. Fields the result does not vouch for
// stay unknown: a lost system sends no old numbers.
[[nodiscard]] CanEstimate estimate_of(const Publication& publication, const PreviousPose& previous,
                                      const BodyFrames& frames, Timestamp now);

}  // namespace pelorus
