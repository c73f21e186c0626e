#pragma once
// Reading calibration written as YAML: values by key, and an Error with file and line for whatever is missing or
// has the wrong size. No exception of the YAML library leaves these functions. Pure but for reading the file.

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/stereo_calibration.h"

namespace pelorus {

struct CalibrationYaml {
  std::string file;  // as the user named it; first part of every place
  YAML::Node root;   // a map

  [[nodiscard]] std::string place(const YAML::Node& node) const;  // file:line
};

// The whole text of a file.
[[nodiscard]] Result<std::string> read_text(const std::filesystem::path& path);
// Accepts OpenCV's "%YAML:1.0" first line, which is not YAML.
[[nodiscard]] Result<CalibrationYaml> read_calibration_yaml(const std::filesystem::path& path);

// Child of a map; undefined (false) when absent or when `map` is no map.
[[nodiscard]] YAML::Node child(const YAML::Node& map, const std::string& key);
// Required values. `count_min..count_max` is the accepted number of entries; nested lists (rows) are flattened.
[[nodiscard]] Result<std::vector<double>> numbers(const CalibrationYaml& yaml, const YAML::Node& map,
                                                  const std::string& key, std::size_t count_min, std::size_t count_max);
[[nodiscard]] Result<std::string> text(const CalibrationYaml& yaml, const YAML::Node& map, const std::string& key);

// Lens model by any of the names in use (radtan, radial-tangential, plumb_bob, rational_polynomial, equidistant,
// fisheye, kannala_brandt, none) and its coefficients; `place` goes into the Error.
[[nodiscard]] Result<> set_lens(CameraIntrinsics& camera, const std::string& model, const std::vector<double>& k,
                                const std::string& place);
// Rigid transform from 16 numbers, row by row; refuses what is not one.
[[nodiscard]] Result<Rigid3> rigid_from_rows(const std::vector<double>& m, const std::string& place);

}  // namespace pelorus
