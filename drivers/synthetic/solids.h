#pragma once
// Boxes and ellipsoids in the water: the scene's bodies and the rocks of the seabed, intersected in their own
// coordinates. Frame: sea. Pure after construction.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "drivers/synthetic/ray_batch.h"
#include "drivers/synthetic/scene.h"
#include "drivers/synthetic/seafloor.h"

namespace pelorus::synthetic {

struct Solid {
  Shape shape = Shape::box;
  Eigen::Vector3f half_size_m;
  Eigen::Matrix3f R_sea_obj;
  Eigen::Vector3f p_sea;  // centre
  float contrast = 1;
  float brightness = 1;
  std::uint32_t seed = 0;  // of the texture
  bool casts_shadow = true;
};

// A rectangle of the picture that contains a solid's image; empty when u_max < u_min.
struct ImageBounds {
  float u_min = 0, u_max = -1, v_min = 0, v_max = -1;
};

// Half-buried stones along the vehicle's path.
[[nodiscard]] std::vector<Solid> place_rocks(const Scene& scene, const Seafloor& floor);
// The bodies at a time, in the order of the scene.
[[nodiscard]] std::vector<Solid> place_bodies(const Scene& scene, double t_s);

// Conservative bounds for a camera at p_sea_cam with axes R_cam_sea.
[[nodiscard]] ImageBounds image_bounds(const Solid& solid, const Eigen::Vector3f& p_sea_cam,
                                       const Eigen::Matrix3f& R_cam_sea, const SceneCamera& camera);
// Replaces the hits of the batch that lie behind the solid's surface.
void intersect(const Solid& solid, int index, RayBatch& batch);
// Share of light (1 = all) that reaches the hit points past the solid; light from direction (directional) or from a
// point. Soft, by the ray's nearest distance to the ellipsoid around the solid.
void shade_by(const Solid& solid, const Eigen::Vector3f& light, bool directional, const RayBatch& batch,
              const std::vector<Eigen::Vector3f>& p_sea_hits, BatchFloats& lit);

}  // namespace pelorus::synthetic
