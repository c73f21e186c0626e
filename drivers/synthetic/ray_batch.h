#pragma once
// A batch of viewing rays and what they hit, one array per quantity so that loops over a batch vectorise.
// A ray is origin + t * (dx, dy, dz) in the sea frame with t the depth along the camera's axis [m]: the arrays hold
// exactly what the stereo truth needs. Pure data.

#include <array>
#include <cstdint>

namespace pelorus::synthetic {

inline constexpr int kBatch = 64;
inline constexpr float kFarM = 60.0F;          // beyond: open water
inline constexpr std::int32_t kKeyWater = -1;  // nothing hit
inline constexpr std::int32_t kFacesPerSolid = 8;
// Key of a surface: 0 is the seabed, 8 (1 + solid) + face a solid's face. An image edge is where keys differ.
[[nodiscard]] constexpr std::int32_t surface_key(int solid, int face) { return kFacesPerSolid * (1 + solid) + face; }
[[nodiscard]] constexpr int solid_of_key(std::int32_t key) { return key / kFacesPerSolid - 1; }

using BatchFloats = std::array<float, kBatch>;

struct alignas(64) RayBatch {
  int size = 0;
  std::array<float, 3> origin{};  // camera centre, sea frame
  BatchFloats u, v;               // pixel position of the ray
  BatchFloats dx, dy, dz;
  BatchFloats t;           // depth of the hit [m]
  BatchFloats px, py, pz;  // hit in the coordinates of its surface: sea for the seabed, else the solid's own
  BatchFloats nx, ny, nz;  // outward normal, sea frame
  BatchFloats footprint;   // width that a pixel covers on the surface [m]
  BatchFloats contrast, brightness;
  BatchFloats radiance;
  std::array<std::uint32_t, kBatch> seed;  // of the texture
  std::array<std::int32_t, kBatch> key;
};

}  // namespace pelorus::synthetic
