#include "drivers/synthetic/lighting.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "drivers/synthetic/seeded_hash.h"
#include "drivers/synthetic/value_noise.h"

namespace pelorus::synthetic {
namespace {

constexpr float kLampReferenceM = 3.0F;

}  // namespace

float decay(float x) {
  const float scaled = std::max(x, -80.0F) * 1.44269504F;
  const int whole = lattice::floor_to_int(scaled + 0.5F);
  const float y = (scaled - static_cast<float>(whole)) * 0.693147181F;
  const float series =
      1.0F + y * (1.0F + y * (0.5F + y * (1.0F / 6 + y * (1.0F / 24 + y * (1.0F / 120 + y * (1.0F / 720))))));
  return series * std::bit_cast<float>((whole + 127) << 23);  // 2^whole
}

Lighting::Lighting(const Scene& scene, double t_s, const Rigid3& T_sea_cam, const std::vector<Solid>& solids)
    : solids_(&solids),
      water_(scene.water),
      light_(scene.light),
      daylight_(static_cast<float>(scene.light.daylight)),
      time_s_(static_cast<float>(t_s)),
      cos_half_beam_(static_cast<float>(std::cos(scene.light.beam_rad))),
      caustics_seed_(SeededHash(scene.seed, Purpose::caustics, 0).bits32()),
      v_sea_sun_(Eigen::Vector3f(0.35F, 0.25F, -0.9F).normalized()),
      p_sea_lamp_((T_sea_cam * Eigen::Vector3d(0.45, -0.35, 0)).cast<float>()),
      v_sea_beam_(T_sea_cam.linear().col(2).cast<float>()) {}

float Lighting::lamp_at(float cos_axis, float distance_m) const {
  // cos^n that falls to a half at beam_rad; inverse square law; attenuation from the lamp.
  const float off_axis = (1.0F - cos_axis) / (1.0F - cos_half_beam_);
  const float beam = decay(-0.6931F * off_axis);
  const float near_m = std::max(distance_m, 0.3F);
  const float spread = kLampReferenceM * kLampReferenceM / (near_m * near_m);
  const float lost = decay(-static_cast<float>(water_.attenuation_per_m) * (distance_m - kLampReferenceM));
  return static_cast<float>(light_.carried) * beam * spread * lost;
}

float Lighting::light_on_flake(const Eigen::Vector3f& p_sea) const {
  float light = daylight_;
  if (light_.carried > 0) {
    const Eigen::Vector3f from_lamp = p_sea - p_sea_lamp_;
    const float distance = from_lamp.norm();
    light += lamp_at(from_lamp.dot(v_sea_beam_) / std::max(distance, 1e-3F), distance);
  }
  return light;
}

void Lighting::add_daylight(const RayBatch& batch, const std::vector<Eigen::Vector3f>& hits, BatchFloats& light) const {
  constexpr float kWrap = 0.4F;  // light comes from a wide cone, so it reaches round the edge of a body
  const auto ambient = static_cast<float>(light_.ambient);
  BatchFloats lit;
  lit.fill(1);
  if (light_.shadow > 0) {
    for (const Solid& solid : *solids_)
      if (solid.casts_shadow) shade_by(solid, v_sea_sun_, true, batch, hits, lit);
  }
  const auto shadow = static_cast<float>(light_.shadow);
  for (int i = 0; i < kBatch; ++i) {
    const float facing = batch.nx[i] * v_sea_sun_.x() + batch.ny[i] * v_sea_sun_.y() + batch.nz[i] * v_sea_sun_.z();
    const float direct = std::max(0.0F, (facing + kWrap) / (1.0F + kWrap));
    light[i] = daylight_ * (ambient + (1.0F - ambient) * direct * (1.0F - shadow * (1.0F - lit[i])));
  }
}

void Lighting::add_lamp(const RayBatch& batch, const std::vector<Eigen::Vector3f>& hits, BatchFloats& light) const {
  BatchFloats lit;
  lit.fill(1);
  if (light_.shadow > 0) {
    for (const Solid& solid : *solids_)
      if (solid.casts_shadow) shade_by(solid, p_sea_lamp_, false, batch, hits, lit);
  }
  const auto shadow = static_cast<float>(light_.shadow);
  for (int i = 0; i < batch.size; ++i) {
    const Eigen::Vector3f to_lamp = p_sea_lamp_ - hits[static_cast<std::size_t>(i)];
    const float distance = to_lamp.norm();
    const Eigen::Vector3f v = to_lamp / distance;
    const float facing = batch.nx[i] * v.x() + batch.ny[i] * v.y() + batch.nz[i] * v.z();
    const float share = std::max(0.0F, facing) * (1.0F - shadow * (1.0F - lit[i]));
    light[i] += share * lamp_at(-v.dot(v_sea_beam_), distance);
  }
}

void Lighting::add_caustics(const std::vector<Eigen::Vector3f>& hits, BatchFloats& light) const {
  const float per_m = 1.0F / static_cast<float>(light_.caustics_size_m);
  const auto swing = static_cast<float>(light_.caustics);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    // Follows the sun's rays down, so that bodies higher in the water carry the same net.
    const float height = hits[i].z() / v_sea_sun_.z();
    const float x = (hits[i].x() - height * v_sea_sun_.x()) * per_m;
    const float y = (hits[i].y() - height * v_sea_sun_.y()) * per_m;
    const float n = value_noise_3d(x, y, 0.9F * time_s_, caustics_seed_) +
                    0.5F * value_noise_3d(2.1F * x, 2.1F * y, 1.7F * time_s_, ~caustics_seed_);
    const float ridge = 1.0F / (1.0F + 14.0F * n * n);  // bright thin lines where the noise crosses zero
    light[i] *= 1.0F + swing * (2.0F * ridge - 0.9F);
  }
}

void Lighting::illuminate(RayBatch& batch) const {
  std::vector<Eigen::Vector3f> hits(kBatch, Eigen::Vector3f::Zero());
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.size); ++i) {
    hits[i] = {batch.origin[0] + batch.t[i] * batch.dx[i], batch.origin[1] + batch.t[i] * batch.dy[i],
               batch.origin[2] + batch.t[i] * batch.dz[i]};
  }
  BatchFloats light{};
  add_daylight(batch, hits, light);
  if (light_.caustics > 0) add_caustics(hits, light);
  if (light_.carried > 0) add_lamp(batch, hits, light);
  const auto attenuation = static_cast<float>(water_.attenuation_per_m);
  const auto backscatter = static_cast<float>(water_.backscatter_per_m);
  const auto veil = static_cast<float>(water_.veil);
  for (int i = 0; i < batch.size; ++i) {
    const float ray = std::sqrt(batch.dx[i] * batch.dx[i] + batch.dy[i] * batch.dy[i] + batch.dz[i] * batch.dz[i]);
    const float range = batch.t[i] * ray;
    const bool open_water = batch.key[i] == kKeyWater;
    if (attenuation > 0) batch.radiance[i] *= decay(-attenuation * range);
    batch.radiance[i] = open_water ? 0.0F : batch.radiance[i] * light[i];
    if (backscatter <= 0 && !open_water) continue;
    const Eigen::Vector3f v(batch.dx[i] / ray, batch.dy[i] / ray, batch.dz[i] / ray);
    const float glow = daylight_ * static_cast<float>(light_.ambient) + lamp_at(v.dot(v_sea_beam_), kLampReferenceM);
    const float thickness = open_water ? 1.0F : 1.0F - decay(-backscatter * range);
    batch.radiance[i] += veil * glow * thickness;
  }
}

}  // namespace pelorus::synthetic
