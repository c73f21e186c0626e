#pragma once
// write_calibration: a calibration into any of the formats load_calibration reads, with all digits, so that reading
// it back gives the same pair. What a format cannot hold is an Error, not a silent loss. All files or none: they get
// their names when all of them are written. Thread-bound.

#include <filesystem>

#include "core/base/result.h"
#include "core/geometry/stereo_calibration.h"

namespace pelorus {

// opencv, kalibr: one YAML file. ros: a folder with left.yaml and right.yaml. euroc: a folder with
// mav0/cam0/sensor.yaml and mav0/cam1/sensor.yaml.
enum class CalibrationFormat { opencv, kalibr, ros, euroc };

[[nodiscard]] Result<> write_calibration(const StereoCalibration& calibration, CalibrationFormat format,
                                         const std::filesystem::path& out, bool overwrite = true);

}  // namespace pelorus
