#include "firmware-host/pelorusd/mounting.h"

namespace pelorus {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;

// Looking ahead: image right is starboard, image down is down.
Eigen::Matrix3d looking_ahead() {
  Eigen::Matrix3d R_body_cam;
  R_body_cam << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return R_body_cam;
}

}  // namespace

Mounting mounting_of(const MountingConfig& config, const Rectifier& rectifier, bool body_known) {
  Mounting mounting;
  if (config.given) {
    const Eigen::Matrix3d R_yaw = so3_exp({0, 0, kRadPerDeg * config.yaw_deg});
    const Eigen::Matrix3d R_pitch = so3_exp({0, kRadPerDeg * config.pitch_deg, 0});
    const Eigen::Matrix3d R_roll = so3_exp({kRadPerDeg * config.roll_deg, 0, 0});
    mounting.T_body_cam.linear() = R_yaw * R_pitch * R_roll * looking_ahead();
    mounting.T_body_cam.translation() << config.x_m, config.y_m, config.z_m;
    mounting.origin = "camera in the vehicle: as configured (mounting)";
  } else if (body_known) {
    mounting.T_body_cam = rectifier.T_body_cam();
    mounting.origin = "camera in the vehicle: as the calibration says; body is its body frame";
  } else {
    mounting.T_body_cam.linear() = looking_ahead();
    mounting.origin = "camera in the vehicle: not known, taken to be at its origin and to look ahead";
  }
  return mounting;
}

}  // namespace pelorus
