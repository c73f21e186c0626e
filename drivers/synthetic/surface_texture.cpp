#include "drivers/synthetic/surface_texture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "drivers/synthetic/seeded_hash.h"
#include "drivers/synthetic/value_noise.h"

namespace pelorus::synthetic {
namespace {

constexpr double kFinestSpacingM = 0.0042;
constexpr double kSpacingRatio = 1.75;
constexpr int kOctaves = 11;  // up to 1.1 m
// Lattice spacing in pixels between which an octave fades in. Value noise has nothing to speak of above one cycle per
// spacing, and half a cycle per pixel is the limit.
constexpr float kFadeFromPx = 1.4F;
constexpr float kFadeToPx = 2.4F;

}  // namespace

SurfaceTexture::SurfaceTexture(std::uint64_t scene_seed) {
  SeededHash random(scene_seed, Purpose::texture, ~0ULL);
  double spacing_m = kFinestSpacingM;
  for (int i = 0; i < kOctaves; ++i, spacing_m *= kSpacingRatio) {
    // Patches wider than a hand fade in strength: the eye wants them, corners come from the finer ones.
    const double weight = 1.0 / (1.0 + std::pow(spacing_m / 0.12, 1.3));
    Octave octave{static_cast<float>(spacing_m), static_cast<float>(weight), {}, {}, random.bits32()};
    const auto part = [&] { return random.uniform(-1.0, 1.0); };
    const Eigen::Quaterniond q_raw(part(), part(), part(), part());
    const Eigen::Matrix3d R = q_raw.normalized().toRotationMatrix();
    for (std::size_t k = 0; k < 9; ++k)
      octave.R_lattice_obj_per_m[k] =
          static_cast<float>(R(static_cast<int>(k / 3), static_cast<int>(k % 3)) / spacing_m);
    for (float& offset : octave.offset) offset = static_cast<float>(random.uniform(0, 64));
    octaves_.push_back(octave);
  }
}

PELORUS_WIDE_LOOPS void SurfaceTexture::add_octave(const Octave& octave, const RayBatch& batch, float* sum) {
  const float* m = octave.R_lattice_obj_per_m.data();
  for (int i = 0; i < kBatch; ++i) {
    const float x = m[0] * batch.px[i] + m[1] * batch.py[i] + m[2] * batch.pz[i] + octave.offset[0];
    const float y = m[3] * batch.px[i] + m[4] * batch.py[i] + m[5] * batch.pz[i] + octave.offset[1];
    const float z = m[6] * batch.px[i] + m[7] * batch.py[i] + m[8] * batch.pz[i] + octave.offset[2];
    const float n = value_noise_3d(x, y, z, octave.seed ^ batch.seed[i]);
    const float spacing_px = octave.spacing_m / batch.footprint[i];
    const float ramp = (spacing_px - kFadeFromPx) * (1.0F / (kFadeToPx - kFadeFromPx));
    const float s = ramp < 0.0F ? 0.0F : (ramp > 1.0F ? 1.0F : ramp);
    // Spots with edges: the gain grows with the room there is, and saturates.
    const float room = 0.30F * spacing_px;
    const float gain = room < 1.0F ? 1.0F : (room > 5.0F ? 5.0F : room);
    const float spot = gain * n;
    sum[i] += octave.weight * s * s * (3.0F - 2.0F * s) * (spot / std::sqrt(1.0F + spot * spot));
  }
}

void SurfaceTexture::paint(RayBatch& batch) const {
  const float finest = *std::min_element(batch.footprint.begin(), batch.footprint.begin() + batch.size);
  BatchFloats sum{};
  for (const Octave& octave : octaves_) {
    if (octave.spacing_m > kFadeFromPx * finest) add_octave(octave, batch, sum.data());
  }
  constexpr float kContrast = 0.42F;
  for (int i = 0; i < kBatch; ++i) {
    const float x = kContrast * batch.contrast[i] * sum[i];
    batch.radiance[i] = batch.brightness[i] * 0.5F * (1.0F + 0.92F * x / std::sqrt(1.0F + x * x));
  }
}

}  // namespace pelorus::synthetic
