#pragma once
// open_source: whatever names a recording becomes a StereoSource: a data-set folder (drivers/replay), a scene file or
// the name of a shipped scene (drivers/synthetic). Thread-bound.

#include <memory>
#include <string>

#include "core/base/result.h"
#include "drivers/stereo_source.h"

namespace pelorus {

// `calibration_file` may be empty: the data set's own calibration is taken then.
[[nodiscard]] Result<std::unique_ptr<StereoSource>> open_source(const std::string& dataset,
                                                                const std::string& calibration_file);

}  // namespace pelorus
