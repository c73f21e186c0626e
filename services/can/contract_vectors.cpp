#include <cstdio>

#include "drivers/can/candump_log.h"
#include "services/can/contract_text.h"

namespace pelorus {
namespace {

void put_motion(CanEstimate& e, double sign) {
  e.vel_x_mps = sign * 1.234;
  e.vel_y_mps = sign * -0.056;
  e.vel_z_mps = sign * 0.007;
  e.step_x_m = sign * 0.0617;
  e.step_y_m = sign * -0.0028;
  e.step_z_m = sign * 0.0004;
  e.turn_x_rad = sign * 0.001;
  e.turn_y_rad = sign * -0.002;
  e.turn_z_rad = sign * 0.003;
  e.step_var_x_mm2 = e.step_var_y_mm2 = 0.25;
  e.step_var_z_mm2 = 1.0;
  e.turn_var_x_mrad2 = e.turn_var_y_mrad2 = e.turn_var_z_mrad2 = 0.0625;
  e.interval_s = 0.05;
  e.sigma_vel_mps = 0.02;
  e.sigma_step_m = 0.001;
}

void put_pose(CanEstimate& e, double sign) {
  e.roll_rad = sign * 0.0175;
  e.pitch_rad = sign * -0.0349;
  e.yaw_rad = sign * 3.1;
  e.position_x_m = sign * 12.34;
  e.position_y_m = sign * -56.78;
  e.position_z_m = sign * 1200.5;
  e.sigma_att_rad = 0.004;
  e.sigma_position_m = 0.25;
}

void put_body(CanEstimate& e, double sign) {
  e.bodies = 2;
  e.object_bearing_rad = sign * 0.3;
  e.object_elevation_rad = sign * -0.1;
  e.object_range_m = 7.25;
  e.object_closing_mps = sign * 0.45;
  e.object_confidence_percent = 80;
  e.object_id = 17;
  e.object_points = 40;
  e.object_phase = sign > 0 ? 1 : 2;
}

CanEstimate spoken(VisionState state, double quality_percent, double age_s) {
  CanEstimate e;
  e.state = state;
  e.quality_percent = quality_percent;
  e.age_s = age_s;
  e.latency_s = 0.08;
  e.calibration_hash = 0xC0FFEE42;
  e.contract_version = kCanContractVersion;
  return e;
}

}  // namespace

std::vector<ContractVector> contract_vectors() {
  CanEstimate first = spoken(VisionState::tracking, 87, 0.0799);
  put_motion(first, 1);
  put_pose(first, 1);
  put_body(first, 1);
  CanEstimate second = first;
  second.vel_x_mps = 40;  // more than the field holds: sent as invalid, not clipped
  second.sigma_vel_mps = 100;
  second.age_s = 5;  // more than the field holds: the largest value
  CanEstimate third = spoken(VisionState::degraded, 20, 0.0801);
  put_motion(third, -1);
  put_pose(third, -1);
  put_body(third, -1);
  third.resets = 1;
  third.sets_dropped = 3;
  CanEstimate lost = spoken(VisionState::lost, 0, 0.0795);
  lost.resets = 2;
  CanEstimate fault = spoken(VisionState::camera_fault, 0, kCanUnknown);
  fault.resets = 2;
  return {{"tracking", 14, true, first},
          {"beyond the fields", 15, false, second},
          {"degraded after a reset, counter rolled over", 16, true, third},
          {"lost", 17, false, lost},
          {"camera fault, no image to have an age", 18, false, fault}};
}

std::string vectors_log_text(CanTransport transport) {
  std::string out;
  Timestamp time{1'700'000'000'000'000'000};
  for (const ContractVector& vector : contract_vectors()) {
    const CanSet set = encode_set(vector.estimate, {transport, kCanDefaultBaseId, vector.counter, vector.with_slow});
    for (CanFrame frame : set) {
      frame.time = time;
      out += candump_line(frame, "can0") + "\n";
    }
    time = time + std::chrono::milliseconds(50);
  }
  return out;
}

}  // namespace pelorus
