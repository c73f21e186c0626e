#pragma once
// A calibrated, not yet rectified stereo pair, whatever file it came from, and the check that it can be one. Pure.

#include <string>
#include <vector>

#include "core/base/result.h"
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
  bool rectified = false;   // images need no rectification
  bool body_known = false;  // T_body_left was given, not assumed
};

// A calibration with what a user must know about it.
struct LoadedCalibration {
  StereoCalibration calibration;
  std::string origin;                    // format and file(s)
  std::vector<std::string> assumptions;  // one sentence each: direction of extrinsics, defaults taken
};

// Refuses what cannot be a horizontal stereo pair: no baseline, cameras swapped or one above the other, absurd
// focal lengths, principal points or image sizes, rotations that are none. `place` goes into the Error: the file,
// with the line where there is one. Image sizes of 0 (unknown) pass.
[[nodiscard]] Result<> check_calibration(const StereoCalibration& calibration, const std::string& place);

}  // namespace pelorus
