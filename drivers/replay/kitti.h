#pragma once
// KITTI layouts (Geiger et al. 2012, 2013), gray cameras 0 and 1, rectified by the authors.
// odometry: image_0, image_1, times.txt (seconds), calib.txt (P0, P1).
// raw: image_00/data, image_01/data, image_00/timestamps.txt (date and time with nanoseconds, taken as UTC),
// calib_cam_to_cam.txt (P_rect_00, P_rect_01) in the drive's folder or its parent.

#include <filesystem>

#include "drivers/replay/recording.h"

namespace pelorus {

[[nodiscard]] bool is_kitti_odometry(const std::filesystem::path& path);
[[nodiscard]] Result<Recording> list_kitti_odometry(const std::filesystem::path& path);
[[nodiscard]] bool is_kitti_raw(const std::filesystem::path& path);
[[nodiscard]] Result<Recording> list_kitti_raw(const std::filesystem::path& path);
// calib.txt or calib_cam_to_cam.txt, told apart by its keys; also for `load_calibration`.
[[nodiscard]] Result<LoadedCalibration> read_kitti_calibration(const std::filesystem::path& file);

}  // namespace pelorus
