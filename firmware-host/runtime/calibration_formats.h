#pragma once
// The readers behind load_calibration, one per format. Each says in which direction it took the extrinsics. None
// checks the pair as a whole: load_calibration does.

#include <filesystem>

#include "core/base/result.h"
#include "core/geometry/stereo_calibration.h"
#include "drivers/replay/calibration_yaml.h"

namespace pelorus {

// Camera matrices, distortions, R and T under any of the usual names, in one file or several (intrinsics, extrinsics).
// p_right = R p_left + T, as cv::stereoCalibrate returns them.
[[nodiscard]] Result<LoadedCalibration> read_opencv(const std::vector<std::filesystem::path>& files);
[[nodiscard]] bool looks_like_opencv(const CalibrationYaml& yaml);
// cam0 is left, cam1 right; cam1's T_cn_cnm1 maps cam0 to cam1; T_cam_imu, when there, places the body.
[[nodiscard]] Result<LoadedCalibration> read_kalibr(const CalibrationYaml& yaml);
// Extrinsics from both rectification matrices and the right projection matrix.
[[nodiscard]] Result<LoadedCalibration> read_ros_pair(const std::filesystem::path& left,
                                                      const std::filesystem::path& right);

}  // namespace pelorus
