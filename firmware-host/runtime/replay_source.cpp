#include "firmware-host/runtime/replay_source.h"

#include <filesystem>
#include <optional>

#include "drivers/replay/dataset.h"
#include "drivers/replay/lcm_event_file.h"
#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"
#include "firmware-host/runtime/calibration.h"
#include "firmware-host/runtime/scene_lookup.h"

namespace pelorus {
namespace {

Result<std::unique_ptr<StereoSource>> open_scene(const std::string& name) {
  const auto path = find_scene(name);
  if (!path) return path.error();
  auto scene = synthetic::load_scene(path.value());
  if (!scene) return scene.error();
  return std::unique_ptr<StereoSource>(std::make_unique<synthetic::SyntheticSource>(std::move(scene.value())));
}

}  // namespace

Result<std::unique_ptr<StereoSource>> open_source(const std::string& dataset, const std::string& calibration_file) {
  std::error_code ignored;
  // Whatever has a path separator and is no file is meant as a folder: its error says more than the scenes' one.
  const bool scene = !LcmEventFile::is_log(dataset) && !std::filesystem::is_directory(dataset, ignored) &&
                     (dataset.find('/') == std::string::npos || std::filesystem::is_regular_file(dataset, ignored));
  if (scene && calibration_file.empty()) return open_scene(dataset);
  if (scene)
    return Error{ErrorCode::bad_usage, "--calib", "a synthetic scene brings its own calibration", "leave --calib out"};
  if (calibration_file.empty()) return open_dataset(dataset);
  const auto calibration = load_calibration(calibration_file);
  if (!calibration) return calibration.error();
  return open_dataset(dataset, calibration.value());
}

}  // namespace pelorus
