#pragma once
// From albedo to the radiance that reaches the camera: Lambert shading by soft daylight and the carried lamp, soft
// shadows of bodies, caustics, attenuation and backscatter on the way (Jaffe 1990, simplest form). Frame: sea. Pure.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "drivers/synthetic/ray_batch.h"
#include "drivers/synthetic/scene.h"
#include "drivers/synthetic/solids.h"

namespace pelorus::synthetic {

// exp(x) for x <= 0, relative error below 1e-6; the same bits everywhere, which the library's is not.
[[nodiscard]] float decay(float x);

class Lighting {
 public:
  Lighting(const Scene& scene, double t_s, const Rigid3& T_sea_cam, const std::vector<Solid>& solids);
  // batch.radiance: albedo in, radiance at the camera out.
  void illuminate(RayBatch& batch) const;
  // Light that falls on something small in the water.
  [[nodiscard]] float light_on_flake(const Eigen::Vector3f& p_sea) const;

 private:
  // Strength of the lamp in a direction (cosine to its axis) at a distance.
  [[nodiscard]] float lamp_at(float cos_axis, float distance_m) const;
  void add_daylight(const RayBatch& batch, const std::vector<Eigen::Vector3f>& hits, BatchFloats& light) const;
  void add_lamp(const RayBatch& batch, const std::vector<Eigen::Vector3f>& hits, BatchFloats& light) const;
  void add_caustics(const std::vector<Eigen::Vector3f>& hits, BatchFloats& light) const;

  const std::vector<Solid>* solids_;
  Water water_;
  Light light_;
  float daylight_;
  float time_s_;
  float cos_half_beam_;
  std::uint32_t caustics_seed_;
  Eigen::Vector3f v_sea_sun_;   // towards the light
  Eigen::Vector3f p_sea_lamp_;  // on the vehicle, beside and above the camera
  Eigen::Vector3f v_sea_beam_;  // axis of the lamp
};

}  // namespace pelorus::synthetic
