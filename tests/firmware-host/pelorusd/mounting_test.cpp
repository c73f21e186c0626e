#include "firmware-host/pelorusd/mounting.h"

#include <gtest/gtest.h>

#include "drivers/synthetic/synthetic_source.h"

namespace pelorus {
namespace {

Rectifier rectifier() {
  StereoCalibration calibration;
  for (CameraIntrinsics* camera : {&calibration.left, &calibration.right}) {
    *camera = {.width = 320, .height = 240, .fx_px = 250, .fy_px = 250, .cx_px = 160, .cy_px = 120};
  }
  calibration.T_right_left.translation().x() = -0.12;
  calibration.T_body_left.translation() << 1, 2, 3;
  calibration.rectified = true;
  return Rectifier::create(calibration, "test").value();
}

const Eigen::Vector3d kForward(1, 0, 0), kStarboard(0, 1, 0), kDown(0, 0, 1);
const Eigen::Vector3d kOptical(0, 0, 1), kImageRight(1, 0, 0);

TEST(Mounting, UnknownMeansLookingAhead) {
  const Mounting m = mounting_of({}, rectifier(), false);
  EXPECT_TRUE((m.T_body_cam.linear() * kOptical).isApprox(kForward));
  EXPECT_TRUE((m.T_body_cam.linear() * kImageRight).isApprox(kStarboard));
  EXPECT_NE(m.origin.find("not known"), std::string::npos);
}

TEST(Mounting, PitchedDownByNinetyDegreesLooksDownWithForwardUpInTheImage) {
  MountingConfig config{.given = true, .x_m = 0.5, .pitch_deg = -90};
  const Mounting m = mounting_of(config, rectifier(), true);
  EXPECT_TRUE((m.T_body_cam.linear() * kOptical).isApprox(kDown));
  EXPECT_TRUE((m.T_body_cam.linear() * kImageRight).isApprox(kStarboard));
  EXPECT_DOUBLE_EQ(m.T_body_cam.translation().x(), 0.5);
}

TEST(Mounting, YawedByNinetyDegreesLooksToStarboard) {
  const Mounting m = mounting_of({.given = true, .yaw_deg = 90}, rectifier(), false);
  EXPECT_TRUE((m.T_body_cam.linear() * kOptical).isApprox(kStarboard));
}

TEST(Mounting, ACalibrationThatKnowsTheBodyIsBelieved) {
  EXPECT_TRUE(mounting_of({}, rectifier(), true).T_body_cam.translation().isApprox(Eigen::Vector3d(1, 2, 3)));
}

TEST(Mounting, ARenderedCameraLooksDownAsItsSceneSaysUnlessConfigured) {
  synthetic::Scene scene;
  scene.vehicle.p_sea = {Eigen::Vector3d::Zero()};
  scene.vehicle.rpy_rad = {Eigen::Vector3d::Zero()};
  scene.camera.look_down_rad = 1.2;
  const synthetic::SyntheticSource source(scene, 1);
  const Rectifier rectified = Rectifier::create(source.calibration(), "test").value();
  const Mounting m = mounting_of({}, rectified, source.calibration().body_known);
  const Eigen::Vector3d ahead_and_down(std::cos(1.2), 0, std::sin(1.2));
  EXPECT_TRUE((m.T_body_cam.linear() * kOptical).isApprox(ahead_and_down)) << m.origin;
  EXPECT_TRUE((m.T_body_cam.linear() * kImageRight).isApprox(kStarboard));
  const Mounting given = mounting_of({.given = true}, rectified, source.calibration().body_known);
  EXPECT_TRUE((given.T_body_cam.linear() * kOptical).isApprox(kForward));
}

}  // namespace
}  // namespace pelorus
