#pragma once
// Finds a synthetic scene: the path of a file as it is, or the name of a shipped scene ("paper").

#include <string>

#include "core/base/result.h"

namespace pelorus {

// The path of the scene file; the error lists the shipped scenes.
[[nodiscard]] Result<std::string> find_scene(const std::string& scene);

}  // namespace pelorus
