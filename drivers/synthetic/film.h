#pragma once
// What one camera gathers before it becomes 8-bit grey: radiance, depth and surface of every pixel; then blur by
// range, marine snow and the sensor. Thread-bound (uses several threads inside).

#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "drivers/synthetic/scene.h"

namespace pelorus::synthetic {

struct Film {
  int width = 0;
  int height = 0;
  std::vector<float> radiance;     // white diffuse surface in full light = 1
  std::vector<float> depth;        // along the camera's axis [m]
  std::vector<std::int32_t> keys;  // surface_key
  std::vector<float> scratch;

  void resize(int width_px, int height_px);
  [[nodiscard]] std::size_t at(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
  }
};

// Forward scattering: a Gaussian whose sigma grows with the depth of each pixel.
void blur_by_depth(double px_per_m, int threads, Film& film);

// Gain, shot and read noise, 8 bits. `shot` numbers the exposure: each has its own noise.
void expose(const Film& film, const Sensor& sensor, std::uint64_t scene_seed, std::uint64_t shot, int threads,
            Image& image);

}  // namespace pelorus::synthetic
