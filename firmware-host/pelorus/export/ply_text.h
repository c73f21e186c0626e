#pragma once
// Point clouds of a run as PLY: the static scene in `world`, each body in its own frame, joined over its views (paper
// section 8 b). Binary little-endian, as every viewer reads it. Pure.

#include <string>
#include <vector>

#include "firmware-host/pelorus/results/scene_reader.h"

namespace pelorus {

// Bodies with points, ascending; kWorldBody first when the static scene has any.
[[nodiscard]] std::vector<BodyId> bodies_of(const std::vector<ScenePoint>& points);

// Vertices x, y, z [m], gray as red, green, blue, spread [m] and views of the points of `body`.
[[nodiscard]] std::string ply_text(const std::vector<ScenePoint>& points, BodyId body);

}  // namespace pelorus
