#include "drivers/synthetic/scene.h"

#include <cmath>

#include "drivers/synthetic/seeded_hash.h"

namespace pelorus::synthetic {

void Scene::reseed(std::uint64_t new_seed) {
  seed = new_seed;
  vehicle.sway_seed = mix64(seed);
  for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].path.sway_seed = mix64(seed + k + 1);
}

// Columns: the camera's x (right), y (down in the image), z (forward) in vehicle axes (forward, starboard, down).
Rigid3 SceneCamera::T_body_cam() const {
  const double c = std::cos(look_down_rad);
  const double s = std::sin(look_down_rad);
  Rigid3 T = Rigid3::Identity();
  T.linear() << 0, -s, c,  //
      1, 0, 0,             //
      0, c, s;
  return T;
}

Rigid3 Scene::T_sea_cam(int frame) const { return vehicle.T_sea_b(time_s(frame)) * camera.T_body_cam(); }

}  // namespace pelorus::synthetic
