#pragma once
// A calibrated, not yet rectified stereo pair, whatever file it came from. Pure data.

#include "core/geometry/lens_model.h"
#include "core/geometry/transform.h"

namespace pelorus {

struct StereoCalibration {
  CameraIntrinsics left;
  CameraIntrinsics right;
  // Maps coordinates of the left camera to the right one: p_right = T_right_left * p_left. For a rectified
  // pair: rotation identity, translation (-baseline_m, 0, 0).
  Rigid3 T_right_left = Rigid3::Identity();
  // Vehicle body (or the data set's body frame) from the raw left camera, when known: for ground truth.
  Rigid3 T_body_left = Rigid3::Identity();
  bool rectified = false;  // images need no rectification
};

}  // namespace pelorus
