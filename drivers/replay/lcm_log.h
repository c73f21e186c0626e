#pragma once
// Stereo pairs of an LCM log: messages bot_core.images_t that hold a LEFT and a RIGHT picture, raw gray or JPEG, of the
// first channel that carries such. Pairs are numbered by time, so that gaps show. The log brings no calibration.

#include <filesystem>
#include <memory>
#include <optional>

#include "drivers/stereo_source.h"

namespace pelorus {

// Errors: no such messages, times out of order, no calibration given or one of another picture size.
[[nodiscard]] Result<std::unique_ptr<StereoSource>> open_lcm_log(const std::filesystem::path& path,
                                                                 const std::optional<LoadedCalibration>& calibration);

}  // namespace pelorus
