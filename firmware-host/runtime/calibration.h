#pragma once
// load_calibration: whatever calibration file a user has becomes a checked LoadedCalibration. Thread-bound.
// The format is told from the content: OpenCV stereo YAML or XML (one file, or a folder with intrinsics.yml and
// extrinsics.yml), Kalibr camchain, ROS camera_info pair (a folder with left.yaml and right.yaml, either of the
// two, or "left.yaml,right.yaml"), EuRoC (folder or sensor.yaml), KITTI calib.txt and calib_cam_to_cam.txt,
// and any data set that open_dataset reads. Errors name file and line.

#include <string>

#include "core/base/result.h"
#include "core/geometry/stereo_calibration.h"

namespace pelorus {

[[nodiscard]] Result<LoadedCalibration> load_calibration(const std::string& path);

}  // namespace pelorus
