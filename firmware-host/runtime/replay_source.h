#pragma once
// open_source: whatever names a recording becomes a StereoSource: a data-set folder or an LCM log (drivers/replay), a
// scene file or the name of a shipped scene (drivers/synthetic). Thread-bound.

#include <memory>
#include <string>

#include "core/base/result.h"
#include "drivers/stereo_source.h"

namespace pelorus {

// `calibration_file` may be empty: the data set's own calibration is taken then. The error about a path that does not
// exist says what is there instead.
[[nodiscard]] Result<std::unique_ptr<StereoSource>> open_source(const std::string& dataset,
                                                                const std::string& calibration_file);

// True for a scene file or a shipped scene's name, false for a recording and for what does not exist.
[[nodiscard]] bool is_scene(const std::string& dataset);

// Looks at the first pairs of a recording for what no later step would notice (side_check.h); scenes pass.
[[nodiscard]] Result<> check_recording(const std::string& dataset, const std::string& calibration_file);

// What DATASET stands for, for the verbs' help.
inline constexpr const char* kDatasetHelp =
    "Folder of a recording (EuRoC, KITTI odometry or raw), LCM log (with --calib), scene file or shipped scene's name";

}  // namespace pelorus
