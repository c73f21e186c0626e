#include "firmware-host/runtime/scene_lookup.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

namespace pelorus {
namespace {

namespace fs = std::filesystem;

// Where shipped scenes are: beside the sources (build/bin/pelorus) or installed (bin/pelorus).
std::vector<fs::path> scene_folders() {
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  return {here / "../../config/scenes", here / "../share/pelorus/scenes", "config/scenes"};
}

}  // namespace

Result<std::string> find_scene(const std::string& scene) {
  std::error_code error;
  if (fs::is_regular_file(scene, error)) return scene;
  std::vector<std::string> shipped;
  for (const fs::path& folder : scene_folders()) {
    if (fs::is_regular_file(folder / (scene + ".yaml"), error))
      return fs::weakly_canonical(folder / (scene + ".yaml"), error).string();
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (entry.path().extension() == ".yaml") shipped.push_back(entry.path().stem().string());
  }
  std::sort(shipped.begin(), shipped.end());
  shipped.erase(std::unique(shipped.begin(), shipped.end()), shipped.end());
  std::string names;
  for (const std::string& name : shipped) names += (names.empty() ? "" : ", ") + name;
  return Error{ErrorCode::bad_usage, scene, "is neither a scene file nor the name of a shipped scene",
               names.empty() ? "no shipped scenes were found: give a path" : "shipped scenes: " + names};
}

}  // namespace pelorus
