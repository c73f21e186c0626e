#include "firmware-host/runtime/replay_source.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "drivers/replay/dataset.h"
#include "drivers/replay/lcm_event_file.h"
#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"
#include "firmware-host/runtime/calibration.h"
#include "firmware-host/runtime/scene_lookup.h"
#include "firmware-host/runtime/side_check.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

// As lcm-logger names them (lcmlog-2014-05-01.00), and as people do.
bool is_named_as_log(const fs::path& path) {
  return path.filename().string().find("lcm") != std::string::npos || path.extension() == ".log";
}

// Anything but a scene would be told off as bad YAML.
Result<> check_scene_name(const fs::path& path) {
  if (path.extension() == ".yaml" || path.extension() == ".yml") return Ok{};
  if (is_named_as_log(path))
    return Error{ErrorCode::bad_input, path.string(), "the LCM log is damaged: it does not begin with an event",
                 "copy it again, or cut off what comes before the first event"};
  return Error{ErrorCode::bad_input, path.string(), "is neither an LCM log nor a scene file (.yaml)",
               "pass the folder of a recording, an LCM log or a scene file"};
}

Result<std::unique_ptr<StereoSource>> open_scene(const std::string& path) {
  auto scene = synthetic::load_scene(path);
  if (!scene) return scene.error();
  return std::unique_ptr<StereoSource>(std::make_unique<synthetic::SyntheticSource>(std::move(scene.value())));
}

// What the nearest folder above that does exist holds.
std::string what_exists(const std::string& dataset) {
  constexpr std::size_t kMostNames = 10;
  std::error_code error;
  fs::path folder = fs::path(dataset).parent_path();
  while (!folder.empty() && folder.has_relative_path() && !fs::is_directory(folder, error))
    folder = folder.parent_path();
  if (folder.empty()) folder = ".";
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (const std::string name = entry.path().filename().string(); !name.starts_with('.')) names.push_back(name);
  std::sort(names.begin(), names.end());
  const bool all = names.size() <= kMostNames;
  if (!all) names.resize(kMostNames);
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  const std::string place = folder == "." ? "this folder" : folder.string();
  return place + (names.empty() ? " is empty" : " holds " + text + (all ? "" : ", ..."));
}

Error no_such_dataset(const std::string& dataset, const Error& no_scene) {
  return {ErrorCode::bad_input, dataset, "does not exist; " + what_exists(dataset),
          "check the path, or name a shipped scene; " + no_scene.cure};
}

}  // namespace

bool is_scene(const std::string& dataset) {
  std::error_code ignored;
  if (fs::is_directory(dataset, ignored) || LcmEventFile::is_log(dataset)) return false;
  return find_scene(dataset).ok();
}

Result<std::unique_ptr<StereoSource>> open_source(const std::string& dataset, const std::string& calibration_file) {
  std::error_code ignored;
  const bool recording = fs::is_directory(dataset, ignored) || LcmEventFile::is_log(dataset);
  if (!recording) {
    const Result<std::string> scene = find_scene(dataset);
    if (!scene) return no_such_dataset(dataset, scene.error());
    if (const Result<> named = check_scene_name(scene.value()); !named) return named.error();
    if (!calibration_file.empty())
      return Error{ErrorCode::bad_usage, "--calib", "a synthetic scene brings its own calibration",
                   "leave --calib out"};
    return open_scene(scene.value());
  }
  if (calibration_file.empty()) return open_dataset(dataset);
  const auto calibration = load_calibration(calibration_file);
  if (!calibration) return calibration.error();
  return open_dataset(dataset, calibration.value());
}

Result<> check_recording(const std::string& dataset, const std::string& calibration_file) {
  if (is_scene(dataset)) return Ok{};
  Result<std::unique_ptr<StereoSource>> source = open_source(dataset, calibration_file);
  if (!source) return source.error();
  return check_sides(*source.value(), dataset);
}

}  // namespace pelorus
