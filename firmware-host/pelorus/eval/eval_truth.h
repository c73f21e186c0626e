#pragma once
// read_truth: what a data set knows about itself, brought to the frames of a run: EuRoC state_groundtruth_estimate0
// (body frame, to the rectified left camera through T_BS and the rectification) with object<k> where there are any;
// KITTI odometry poses.txt; KITTI raw poses_cam0_from_oxts.txt and tracking_label_02.txt; a synthetic scene itself.
// Errors name file and line. Thread-bound.

#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/evaluation/records.h"

namespace pelorus {

// Absent when the data set has no truth.
[[nodiscard]] Result<std::optional<Truth>> read_truth(const std::string& dataset, const std::string& calibration_file,
                                                      const EstimatedRun& run);

}  // namespace pelorus
