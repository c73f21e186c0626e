#pragma once
// What one CAN estimate says, in SI units, before it is scaled into frames and after it is read back: the fields of
// the contract (can_contract.h points into this struct) and the conversion from a FrameResult to the vehicle's axes.
// Frames: `body` x forward, y starboard, z down; `start` = the body axes at the first accepted frame. NaN = not known.
// Pure; no allocation.

#include <cstdint>
#include <limits>

#include "core/base/time.h"
#include "core/geometry/transform.h"
#include "core/model/stage_data.h"

namespace pelorus {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Scalars only, so that one row of the contract is one member. Units in the names; signs in the contract.
struct CanEstimate {
  VisionState state = VisionState::init;
  double vel_x_mps = kUnknown, vel_y_mps = kUnknown, vel_z_mps = kUnknown;     // of the body origin, along body axes
  double roll_rad = kUnknown, pitch_rad = kUnknown, yaw_rad = kUnknown;        // of R_start_body
  double step_x_m = kUnknown, step_y_m = kUnknown, step_z_m = kUnknown;        // p_prev_curr, axes of the body at prev
  double turn_x_rad = kUnknown, turn_y_rad = kUnknown, turn_z_rad = kUnknown;  // rotation vector of R_prev_curr
  double step_var_x_mm2 = kUnknown, step_var_y_mm2 = kUnknown, step_var_z_mm2 = kUnknown;
  double turn_var_x_mrad2 = kUnknown, turn_var_y_mrad2 = kUnknown, turn_var_z_mrad2 = kUnknown;
  double position_x_m = kUnknown, position_y_m = kUnknown, position_z_m = kUnknown;  // p_start_body
  double interval_s = kUnknown;  // between the measurement before and this one
  double age_s = kUnknown;       // from mid-exposure to the moment of encoding
  double latency_s = kUnknown;   // the declared one
  double quality_percent = kUnknown;
  double resets = 0;
  double sigma_vel_mps = kUnknown;  // one standard deviation along the worst axis
  double sigma_att_rad = kUnknown;
  double sigma_step_m = kUnknown;
  double sigma_position_m = kUnknown;
  double bodies = kUnknown;  // moving bodies tracked now
  // The nearest of them, seen from the body origin.
  double object_bearing_rad = kUnknown, object_elevation_rad = kUnknown, object_range_m = kUnknown;
  double object_closing_mps = kUnknown;
  double object_confidence_percent = kUnknown;
  double object_id = kUnknown;  // BodyId modulo 255
  double object_points = kUnknown;
  double object_phase = kUnknown;  // 1 seen now, 2 coasting
  double calibration_hash = 0;     // 32 bits
  double contract_version = 0;
  double sets_dropped = 0;
};

// When the result before was captured, so that a step has a length in time.
struct PreviousResult {
  bool known = false;
  std::uint64_t seq = 0;
  Timestamp capture_time;
  bool pose_valid = false;
  int reset_counter = 0;
  Rigid3 T_world_cam = Rigid3::Identity();
};

[[nodiscard]] PreviousResult remember(const FrameResult& result);

// The motion, pose and nearest body of `result` in the vehicle's axes. `now` is of the capture clock: the age is
// now - capture_time, unknown when negative. The step is the pipeline's own when `previous` is the frame it started
// from; after a skipped result it is the difference of the two poses, with the variance of as many steps. Fields the
// result does not vouch for stay unknown: a lost system sends no old numbers.
[[nodiscard]] CanEstimate estimate_of(const FrameResult& result, const PreviousResult& previous,
                                      const Rigid3& T_body_cam, Timestamp now);

// 0 without a valid pose, else 1..100: the share of `kFullQualityPoints` static points times the margin by which
// the static scene was told from the runner-up; at most 50 while DEGRADED.
inline constexpr int kFullQualityPoints = 100;
inline constexpr double kFullQualityConfidence = 0.5;
[[nodiscard]] double quality_percent_of(const FrameResult& result);

}  // namespace pelorus
