#pragma once
// A smooth random texture known at every real position: waves of random direction with amplitudes that grow with
// their length, as natural surfaces have them. Rendering a warp evaluates the waves at the warped positions, so
// that truth is exact to the 8-bit rounding.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "core/base/image.h"

namespace pelorus::test {

class AnalyticTexture {
 public:
  explicit AnalyticTexture(unsigned seed, double shortest_px = 4.0, double contrast = 1.25) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 60; ++i) {
      const double length_px = shortest_px * std::pow(80.0 / shortest_px, unit(rng));
      const double angle = 2 * std::numbers::pi * unit(rng);
      const double k = 2 * std::numbers::pi / length_px;
      waves_.push_back({k * std::cos(angle), k * std::sin(angle), 2 * std::numbers::pi * unit(rng),
                        contrast * std::pow(length_px, 0.6)});
    }
  }

  [[nodiscard]] double operator()(double u, double v) const {
    double sum = 128;
    for (const Wave& w : waves_) sum += w.amplitude * std::cos(w.ku * u + w.kv * v + w.phase);
    return sum;
  }

 private:
  struct Wave {
    double ku, kv, phase, amplitude;
  };
  std::vector<Wave> waves_;
};

struct TexturePlace {
  double u, v;
};

// Pixel (u, v) shows grey(texture(place_of(u, v))) plus noise, rounded. `light` maps (grey, u, v) to grey.
template <class PlaceOf, class Light>
Image render(const AnalyticTexture& texture, int width, int height, double noise, unsigned seed, PlaceOf&& place_of,
             Light&& light) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> gauss(0.0, 1.0);
  Image image(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const TexturePlace p = place_of(u, v);
      const double grey = light(texture(p.u, p.v), u, v) + noise * gauss(rng);
      image.row(v)[u] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
  }
  return image;
}

template <class PlaceOf>
Image render(const AnalyticTexture& texture, int width, int height, double noise, unsigned seed, PlaceOf&& place_of) {
  return render(texture, width, height, noise, seed, place_of, [](double grey, int, int) { return grey; });
}

}  // namespace pelorus::test
