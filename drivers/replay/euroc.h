#pragma once
// EuRoC ASL layout: mav0/cam0 and mav0/cam1 with data.csv, data/<ns>.png and sensor.yaml (Burri et al. 2016).
// Our recorder and the synthetic world write the same. T_BS in sensor.yaml is T_body_camera.

#include <filesystem>

#include "drivers/replay/recording.h"

namespace pelorus {

// The folder that holds cam0 and cam1: `path` itself or its mav0; empty when there is none.
[[nodiscard]] std::filesystem::path find_euroc(const std::filesystem::path& path);
[[nodiscard]] Result<Recording> list_euroc(const std::filesystem::path& mav0);
// From the two sensor.yaml; also for `load_calibration`.
[[nodiscard]] Result<LoadedCalibration> read_euroc_calibration(const std::filesystem::path& mav0);

}  // namespace pelorus
