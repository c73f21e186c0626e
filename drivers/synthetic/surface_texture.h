#pragma once
// Fine aperiodic texture of every surface: octaves of value noise in the surface's own 3D coordinates, each faded out
// before it could alias on the pixel it falls on, and hardened to spots with edges about three pixels wide where the
// pixel is fine enough: natural-looking detail at every scale. Exactly the same pattern from every view. Pure.

#include <array>
#include <cstdint>
#include <vector>

#include "drivers/synthetic/ray_batch.h"

namespace pelorus::synthetic {

class SurfaceTexture {
 public:
  explicit SurfaceTexture(std::uint64_t scene_seed);
  // Albedo (0..1) of the hits (surface coordinates, seed, footprint, contrast, brightness) into batch.radiance.
  void paint(RayBatch& batch) const;

 private:
  struct Octave {
    float spacing_m;
    float weight;
    std::array<float, 9> R_lattice_obj_per_m;  // turned so that no two octaves share axes, scaled by 1 / spacing
    std::array<float, 3> offset;
    std::uint32_t seed;
  };
  static void add_octave(const Octave& octave, const RayBatch& batch, float* sum);
  std::vector<Octave> octaves_;
};

}  // namespace pelorus::synthetic
