#pragma once
// The truth of each layout, one function each; read_truth (eval_truth.h) chooses. All bring Truth::frames to the length
// of the run. Absent = the layout's truth file is not there. Thread-bound.

#include <filesystem>
#include <optional>

#include "core/base/result.h"
#include "core/evaluation/records.h"
#include "drivers/synthetic/synthetic_source.h"

namespace pelorus {

// `mav0` holds cam0; T_body_cam: rectified left camera in the data set's body frame.
[[nodiscard]] Result<std::optional<Truth>> read_euroc_truth(const std::filesystem::path& mav0, const Rigid3& T_body_cam,
                                                            const EstimatedRun& run);
[[nodiscard]] Result<std::optional<Truth>> read_kitti_odometry_truth(const std::filesystem::path& folder,
                                                                     const EstimatedRun& run);
[[nodiscard]] Result<std::optional<Truth>> read_kitti_raw_truth(const std::filesystem::path& folder,
                                                                const EstimatedRun& run);
// Renders every frame of the run again to know how much of each body is seen.
[[nodiscard]] Truth scene_truth(synthetic::SyntheticSource& source, const EstimatedRun& run);

// Sets `moving` of exactly known bodies from their steps between frames of the run.
void mark_moving_bodies(Truth& truth);

}  // namespace pelorus
