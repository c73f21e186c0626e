#pragma once
// Lattice value noise, written so that the compiler vectorises loops over it: no branches, no tables, no calls into
// the math library, hence the same bits on every host. Aperiodic over 2^31 lattice cells. Values are within (-1, 1).
// C2 interpolation (quintic, Perlin 2002). Pure.

#include <bit>
#include <cstdint>

// Functions with hot loops are compiled twice and chosen when the program starts; contraction is off, so both give the
// same bits. Sanitizers cannot run the choice (it precedes their start-up): remove the guard when they can.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PELORUS_WIDE_LOOPS __attribute__((target_clones("avx2", "default")))
#else
#define PELORUS_WIDE_LOOPS
#endif
#define PELORUS_ALWAYS_INLINE inline __attribute__((always_inline))

namespace pelorus::synthetic {

struct NoiseGradient2 {
  float value;
  float d_dx;
  float d_dy;
};

namespace lattice {

inline constexpr std::uint32_t kStepX = 0x9e3779b1U;  // odd, far from each other's multiples
inline constexpr std::uint32_t kStepY = 0x85ebca77U;
inline constexpr std::uint32_t kStepZ = 0xc2b2ae3dU;

PELORUS_ALWAYS_INLINE std::int32_t floor_to_int(float x) {
  const auto i = static_cast<std::int32_t>(x);
  return i - static_cast<std::int32_t>(x < static_cast<float>(i));
}

// Value of a lattice point in [-1, 1): 32-bit multiply-xorshift finalizer (constants: Wellons 2018, "lowbias32").
PELORUS_ALWAYS_INLINE float corner(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x7feb352dU;
  h ^= h >> 15;
  h *= 0x846ca68bU;
  h ^= h >> 16;
  return static_cast<float>(static_cast<std::int32_t>(h)) * 0x1p-31F;
}

PELORUS_ALWAYS_INLINE float fade(float t) { return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F); }
PELORUS_ALWAYS_INLINE float fade_slope(float t) { return 30.0F * t * t * (t * (t - 2.0F) + 1.0F); }
PELORUS_ALWAYS_INLINE float mix(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace lattice

// a where the mask is all ones, b where it is zero: a choice that the compiler cannot turn back into a branch.
PELORUS_ALWAYS_INLINE std::uint32_t mask_of(bool condition) { return 0U - static_cast<std::uint32_t>(condition); }
PELORUS_ALWAYS_INLINE std::uint32_t choose(std::uint32_t mask, std::uint32_t a, std::uint32_t b) {
  return (a & mask) | (b & ~mask);
}
PELORUS_ALWAYS_INLINE float choose(std::uint32_t mask, float a, float b) {
  return std::bit_cast<float>(choose(mask, std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b)));
}

PELORUS_ALWAYS_INLINE float value_noise_3d(float x, float y, float z, std::uint32_t seed) {
  using namespace lattice;
  const std::int32_t ix = floor_to_int(x);
  const std::int32_t iy = floor_to_int(y);
  const std::int32_t iz = floor_to_int(z);
  const float wx = fade(x - static_cast<float>(ix));
  const float wy = fade(y - static_cast<float>(iy));
  const float wz = fade(z - static_cast<float>(iz));
  const std::uint32_t h = seed + static_cast<std::uint32_t>(ix) * kStepX + static_cast<std::uint32_t>(iy) * kStepY +
                          static_cast<std::uint32_t>(iz) * kStepZ;
  const float low =
      mix(mix(corner(h), corner(h + kStepX), wx), mix(corner(h + kStepY), corner(h + kStepX + kStepY), wx), wy);
  const std::uint32_t hz = h + kStepZ;
  const float high =
      mix(mix(corner(hz), corner(hz + kStepX), wx), mix(corner(hz + kStepY), corner(hz + kStepX + kStepY), wx), wy);
  return mix(low, high, wz);
}

PELORUS_ALWAYS_INLINE NoiseGradient2 value_noise_2d(float x, float y, std::uint32_t seed) {
  using namespace lattice;
  const std::int32_t ix = floor_to_int(x);
  const std::int32_t iy = floor_to_int(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const float wx = fade(fx);
  const float wy = fade(fy);
  const std::uint32_t h = seed + static_cast<std::uint32_t>(ix) * kStepX + static_cast<std::uint32_t>(iy) * kStepY;
  const float c00 = corner(h);
  const float c10 = corner(h + kStepX);
  const float c01 = corner(h + kStepY);
  const float c11 = corner(h + kStepX + kStepY);
  const float low = mix(c00, c10, wx);
  const float high = mix(c01, c11, wx);
  return {mix(low, high, wy), mix(c10 - c00, c11 - c01, wy) * fade_slope(fx), (high - low) * fade_slope(fy)};
}

}  // namespace pelorus::synthetic
