#pragma once
// The seabed as a height field: octaves of C2 noise, intersected with viewing rays to well below 0.1 mm (sphere tracing
// with the field's slope bound, then Newton). Method: Hart 1996. Frame: sea. Pure after construction.

#include <array>
#include <cstdint>
#include <vector>

#include "drivers/synthetic/ray_batch.h"
#include "drivers/synthetic/scene.h"

namespace pelorus::synthetic {

class Seafloor {
 public:
  Seafloor(const Seabed& seabed, std::uint64_t scene_seed);

  struct Heights {
    BatchFloats z, dz_dx, dz_dy;
  };
  // z and its slopes at (x, y) for the first `size` entries.
  void evaluate(const BatchFloats& x, const BatchFloats& y, int size, Heights& heights) const;
  [[nodiscard]] float z_at(float x, float y) const;

  // First hit of every ray, from the camera: batch.t, kFarM where there is none.
  void march(RayBatch& batch) const;
  // Newton steps from batch.t; false if a ray did not settle.
  [[nodiscard]] bool polish(RayBatch& batch) const;
  // Key, surface coordinates and normal of the hits at batch.t.
  void describe_hits(RayBatch& batch) const;

 private:
  struct Octave {
    float inverse_spacing;
    float amplitude;
    std::array<float, 2> direction;  // the lattice is turned so that no two octaves share axes
    std::uint32_t seed;
  };
  float depth_m_;
  float slope_bound_ = 0;
  float contrast_;
  float brightness_;
  std::uint32_t texture_seed_;
  std::vector<Octave> octaves_;
};

// Depths of the seabed on every eighth pixel of one view: the starting points of the pixels between.
class SeafloorView {
 public:
  // RaySetter fills the rays of a batch from its u, v.
  template <class RaySetter>
  void trace(const Seafloor& floor, int width, int height, const RaySetter& set_rays) {
    resize(width, height);
    RayBatch batch;
    for (int first = 0; first < node_count(); first += kBatch) {
      fill_positions(first, batch);
      set_rays(batch);
      floor.march(batch);
      store(first, batch);
    }
    find_rough_cells();
  }
  // First hit of every ray of the batch: batch.t.
  void intersect(const Seafloor& floor, RayBatch& batch) const;

 private:
  static constexpr int kSpacing = 8;
  void resize(int width, int height);
  [[nodiscard]] int node_count() const { return columns_ * rows_; }
  void fill_positions(int first, RayBatch& batch) const;
  void store(int first, const RayBatch& batch);
  void find_rough_cells();

  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> depth_;
  std::vector<std::uint8_t> rough_;  // a cell near a jump: its rays are marched
};

}  // namespace pelorus::synthetic
