#include "drivers/synthetic/film.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/synthetic/lighting.h"
#include "drivers/synthetic/row_workers.h"
#include "drivers/synthetic/seeded_hash.h"
#include "drivers/synthetic/value_noise.h"

namespace pelorus::synthetic {

void Film::resize(int width_px, int height_px) {
  width = width_px;
  height = height_px;
  const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  radiance.resize(size);
  depth.resize(size);
  keys.resize(size);
  scratch.resize(size);
}

namespace {

constexpr int kBlurLevels = 96;
constexpr float kSigmaStepPx = 1.0F / 16;
constexpr int kBlurReach = 18;  // three times the largest sigma

// Half kernels (middle first) for sigma = level * kSigmaStepPx, each summing to 1 over both halves.
using BlurKernels = std::vector<std::array<float, kBlurReach + 1>>;

BlurKernels blur_kernels() {
  BlurKernels kernels(kBlurLevels + 1);
  for (int level = 0; level <= kBlurLevels; ++level) {
    auto& kernel = kernels[static_cast<std::size_t>(level)];
    const float sigma = std::max(0.05F, static_cast<float>(level) * kSigmaStepPx);
    float sum = 0;
    for (int k = 0; k <= kBlurReach; ++k) {
      kernel[static_cast<std::size_t>(k)] = decay(-0.5F * static_cast<float>(k * k) / (sigma * sigma));
      sum += (k == 0 ? 1.0F : 2.0F) * kernel[static_cast<std::size_t>(k)];
    }
    for (float& weight : kernel) weight /= sum;
  }
  return kernels;
}

// One pixel of a separable blur along a line of `size` pixels at distance `stride`; the ends repeat.
float blurred(const float* line, std::ptrdiff_t stride, int size, int at, const float* kernel, int reach) {
  float sum = kernel[0] * line[at * stride];
  for (int k = 1; k <= reach; ++k)
    sum += kernel[k] * (line[std::max(at - k, 0) * stride] + line[std::min(at + k, size - 1) * stride]);
  return sum;
}

PELORUS_WIDE_LOOPS void expose_row(const float* radiance, std::uint8_t* pixels, int width, std::uint32_t row_seed,
                                   float gain, float read_variance, float shot_variance) {
  for (int u = 0; u < width; ++u) {
    const auto position = static_cast<std::uint32_t>(u) * lattice::kStepX + row_seed;
    // The sum of four uniform numbers is close enough to Gaussian; its variance is 4/3.
    const float gaussian =
        (lattice::corner(position) + lattice::corner(position + lattice::kStepY) +
         lattice::corner(position + lattice::kStepZ) + lattice::corner(position + lattice::kStepY + lattice::kStepZ)) *
        0.8660254F;
    const float signal = gain * radiance[u];
    const float grey = signal + std::sqrt(read_variance + shot_variance * signal) * gaussian;
    const float clipped = grey < 0.0F ? 0.0F : (grey > 255.0F ? 255.0F : grey);
    pixels[u] = static_cast<std::uint8_t>(static_cast<std::int32_t>(clipped + 0.5F));
  }
}

}  // namespace

void blur_by_depth(double px_per_m, int threads, Film& film) {
  const BlurKernels kernels = blur_kernels();
  const auto per_level = static_cast<float>(px_per_m) / kSigmaStepPx;
  const auto level_of = [&](std::size_t at) {
    return static_cast<int>(std::min(static_cast<float>(kBlurLevels), film.depth[at] * per_level + 0.5F));
  };
  const auto reach_of = [](int level) { return std::min(kBlurReach, (3 * level) / 16 + 1); };
  for_each_row(film.height, threads, [&](int v) {
    for (int u = 0; u < film.width; ++u) {
      const int level = level_of(film.at(u, v));
      film.scratch[film.at(u, v)] = blurred(&film.radiance[film.at(0, v)], 1, film.width, u,
                                            kernels[static_cast<std::size_t>(level)].data(), reach_of(level));
    }
  });
  for_each_row(film.height, threads, [&](int v) {
    for (int u = 0; u < film.width; ++u) {
      const int level = level_of(film.at(u, v));
      film.radiance[film.at(u, v)] = blurred(&film.scratch[film.at(u, 0)], film.width, film.height, v,
                                             kernels[static_cast<std::size_t>(level)].data(), reach_of(level));
    }
  });
}

void expose(const Film& film, const Sensor& sensor, std::uint64_t scene_seed, std::uint64_t shot, int threads,
            Image& image) {
  image.resize(film.width, film.height);
  const SeededHash noise(scene_seed, Purpose::sensor_noise, shot);
  for_each_row(film.height, threads, [&](int v) {
    SeededHash row_noise = noise;
    const std::uint64_t row_seed = mix64(row_noise.bits() + static_cast<std::uint64_t>(v));
    expose_row(&film.radiance[film.at(0, v)], image.row(v), film.width, static_cast<std::uint32_t>(row_seed),
               static_cast<float>(sensor.gain), static_cast<float>(sensor.read_noise_grey * sensor.read_noise_grey),
               static_cast<float>(sensor.shot_noise));
  });
}

}  // namespace pelorus::synthetic
