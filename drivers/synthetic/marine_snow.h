#pragma once
// Marine snow: flakes drifting through the water, drawn into both views as small soft spots in front of what lies
// behind them. Flakes live on a lattice that drifts with the current, so that any frame can be drawn at any time.
// Frame: sea. Pure.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "drivers/synthetic/film.h"
#include "drivers/synthetic/lighting.h"
#include "drivers/synthetic/scene.h"

namespace pelorus::synthetic {

struct Flake {
  Eigen::Vector3f p_sea;
  float size_m = 0;
};

// The flakes near enough to the camera to be seen.
[[nodiscard]] std::vector<Flake> drifting_flakes(const Scene& scene, double t_s, const Rigid3& T_sea_cam);

// Draws the flakes into a film with radiance and depth.
void draw_flakes(const std::vector<Flake>& flakes, const SceneCamera& camera, const Eigen::Vector3f& p_sea_cam,
                 const Eigen::Matrix3f& R_sea_cam, const Lighting& lighting, Film& film);

}  // namespace pelorus::synthetic
