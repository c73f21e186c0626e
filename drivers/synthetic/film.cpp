#include "drivers/synthetic/film.h"

#include <cmath>

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
}

namespace {

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
