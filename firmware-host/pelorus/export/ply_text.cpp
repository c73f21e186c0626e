#include "firmware-host/pelorus/export/ply_text.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace pelorus {
namespace {

static_assert(std::endian::native == std::endian::little, "the numbers are written as they lie in memory");

template <class T>
void put(std::string& text, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  text.append(bytes, sizeof value);
}

}  // namespace

std::vector<BodyId> bodies_of(const std::vector<ScenePoint>& points) {
  std::vector<BodyId> bodies;
  for (const ScenePoint& point : points) bodies.push_back(point.body);
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  return bodies;
}

std::string ply_text(const std::vector<ScenePoint>& points, BodyId body) {
  const auto count = std::count_if(points.begin(), points.end(), [&](const ScenePoint& p) { return p.body == body; });
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text += body == kWorldBody ? "comment frame: world, the rectified left camera at the first frame; meters\n"
                             : "comment frame: body " + std::to_string(body.value) + ", fixed at its birth; meters\n";
  text += "element vertex " + std::to_string(count) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += std::string("property float ") + axis + "\n";
  for (const char* color : {"red", "green", "blue"}) text += std::string("property uchar ") + color + "\n";
  text += "property float spread_m\nproperty int views\nend_header\n";
  for (const ScenePoint& point : points) {
    if (point.body != body) continue;
    for (int axis = 0; axis < 3; ++axis) put(text, static_cast<float>(point.p_body[axis]));
    for (int color = 0; color < 3; ++color) put(text, static_cast<std::uint8_t>(std::clamp(point.gray, 0, 255)));
    put(text, static_cast<float>(point.spread_m));
    put(text, static_cast<std::int32_t>(point.views));
  }
  return text;
}

}  // namespace pelorus
