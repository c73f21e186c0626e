#pragma once
// Counter-based randomness: every random number of a scene is a hash of (seed, what it is for, index), so that
// frame k can be drawn without frame k-1 and the bytes do not depend on the number of threads. Pure.

#include <cstdint>

namespace pelorus::synthetic {

// Finalizer of SplitMix64 (Steele, Lea, Flood 2014).
[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// What a random number is for: two uses never share a sequence.
enum class Purpose : std::uint64_t { texture = 1, terrain, rock, sway, sensor_noise, marine_snow, caustics };

// The sequence of one purpose and one owner (body, cell, frame ...) of a scene; counts its draws.
class SeededHash {
 public:
  constexpr SeededHash(std::uint64_t seed, Purpose purpose, std::uint64_t owner)
      : key_(mix64(mix64(seed ^ (static_cast<std::uint64_t>(purpose) << 56)) + owner)) {}

  [[nodiscard]] constexpr std::uint64_t bits() { return mix64(key_ + 0xd1342543de82ef95ULL * ++draws_); }
  [[nodiscard]] constexpr std::uint32_t bits32() { return static_cast<std::uint32_t>(bits() >> 32); }
  // Uniform in [0, 1).
  [[nodiscard]] constexpr double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  [[nodiscard]] constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }

 private:
  std::uint64_t key_;
  std::uint64_t draws_ = 0;
};

}  // namespace pelorus::synthetic
