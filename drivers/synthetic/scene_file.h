#pragma once
// Reads a scene file (YAML, config/scenes/*.yaml). Strict: an unknown key, a wrong type, a value out of range or a
// missing key is a problem with file and line; all problems of a file are reported together. Pure.

#include <string>

#include "core/base/result.h"
#include "drivers/synthetic/scene.h"

namespace pelorus::synthetic {

[[nodiscard]] Result<Scene> load_scene(const std::string& path);
// `name` stands for the file in messages.
[[nodiscard]] Result<Scene> parse_scene(const std::string& yaml, const std::string& name);

}  // namespace pelorus::synthetic
