#pragma once
// A run as MCAP for Foxglove and PlotJuggler: /camera/pose, /tf, /bodies, /frame. Thread-bound.

#include <filesystem>

#include "core/base/result.h"
#include "core/evaluation/records.h"

namespace pelorus {

// Axes of "world": those of the rectified left camera at the first frame, z forward.
[[nodiscard]] Result<> export_mcap(const EstimatedRun& run, const std::filesystem::path& path, bool overwrite);

}  // namespace pelorus
