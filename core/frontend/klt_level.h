#pragma once
// One pyramid level of Klt for one point; Klt's own parts, not for callers. Pure; rectified pixels of that level.

#include <array>
#include <cmath>

#include "core/frontend/klt.h"
#include "core/kernels/patch.h"

namespace pelorus::klt {

// Power of white noise that passes the spline taps: (sum of squared taps)^2, 0.21..0.25 over all fractions.
inline constexpr float kSplineNoisePower = 0.23F;

struct Place {
  float u_px = 0;
  float v_px = 0;
  bool operator==(const Place&) const = default;
};

inline float distance(Place a, Place b) {
  const float du = a.u_px - b.u_px;
  const float dv = a.v_px - b.v_px;
  return std::sqrt(du * du + dv * dv);
}

// Question and answer of a level.
struct LevelSearch {
  const ImageView& from;
  const ImageView& to;
  Place start_from;
  Place place;
  bool coarser_agreed = false;  // the start is an accepted answer of a coarser level
  float start_ncc = 0;
  float ncc = 0;
  float residual_rms = 0;            // referred to raw pixels
  std::array<float, 3> structure{};  // per pixel, of this level
};

struct TaskWarp {
  bool identity = true;
  std::array<float, 4> A_from_to{1, 0, 0, 1};
};

// False when the warp cannot be inverted (or is not finite): nothing can be compared then.
[[nodiscard]] bool invert(const std::array<float, 4>& A, TaskWarp& warp);

[[nodiscard]] bool inside(const ImageView& image, Place p);  // false for NaN

// Fills and normalises patch (its size given); the window shows only what lies in both images.
void sample_template(const LevelSearch& search, const TaskWarp& warp, PatchTemplate& patch);

// Fills ncc and residual_rms.
void judge(const PatchTemplate& patch, const PatchFit& fit, LevelSearch& search);

[[nodiscard]] KltOutcome track_level(const KltConfig& config, const TaskWarp& warp, KltSearch direction,
                                     float epsilon_px, LevelSearch& search);

// At full resolution: place, du/dx and du/dy together, from where the plain search ended. Leaves search and A alone
// unless the outcome is ok. A maps offsets in `from` to offsets in `to`.
[[nodiscard]] KltOutcome refine_slant(const KltConfig& config, LevelSearch& search, std::array<float, 4>& A);

}  // namespace pelorus::klt
