#include "firmware-host/pelorus/eval/eval_goals.h"

#include <filesystem>

#include "drivers/replay/euroc.h"
#include "drivers/synthetic/scene_file.h"
#include "firmware-host/runtime/replay_source.h"
#include "firmware-host/runtime/scene_lookup.h"

namespace pelorus {

Result<Goals> goals_of(const std::string& dataset) {
  if (is_scene(dataset)) {
    const Result<std::string> path = find_scene(dataset);
    if (!path) return path.error();
    const Result<synthetic::Scene> scene = synthetic::load_scene(path.value());
    if (!scene) return scene.error();
    return scene.value().goals;
  }
  std::error_code ignored;
  if (!std::filesystem::is_directory(dataset, ignored)) return Goals{};
  const std::filesystem::path mav0 = find_euroc(dataset);
  const std::filesystem::path file = (mav0.empty() ? std::filesystem::path(dataset) : mav0) / "goals.yaml";
  if (!std::filesystem::exists(file, ignored)) return Goals{};
  return synthetic::load_goals(file.string());
}

}  // namespace pelorus
