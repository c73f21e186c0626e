#pragma once
// open_dataset: recorded stereo frames as a StereoSource, whatever the layout (EuRoC ASL, KITTI odometry, KITTI raw,
// LCM log with bot_core.images_t).
//
// Losses and errors: an image that is not there, on either side, costs its pair: seq has a gap, description()
// counts it. An image that cannot be decoded or has the wrong size is an Error of next(); the following next() goes
// on with the pair after it. Unsorted or duplicate times, a folder without frames or without a single pair that can be
// decoded, and a calibration that cannot be are Errors of opening.

#include <filesystem>
#include <memory>
#include <optional>

#include "drivers/replay/recording.h"
#include "drivers/stereo_source.h"

namespace pelorus {

// `calibration`: the user's, in place of the one in the data set (whose T_body_left is kept when the user's
// calibration does not know the body).
[[nodiscard]] Result<std::unique_ptr<StereoSource>> open_dataset(
    const std::filesystem::path& path, const std::optional<LoadedCalibration>& calibration = std::nullopt);

// The folder's layout recognised and its images listed, nothing decoded yet.
[[nodiscard]] Result<Recording> list_recording(const std::filesystem::path& path);

}  // namespace pelorus
