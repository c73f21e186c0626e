#pragma once
// Inner loops of patch tracking: sub-pixel sampling of a square patch with gradients, normalisation of a template
// against light (mean and gain), and its comparison with another image.
// Sampling uses the cubic B-spline without prefilter: both images are seen through the same slight smoothing
// (1 4 1)/6, which leaves so little aliasing that the sub-pixel bias of the tracker is several times below that of
// linear or Catmull-Rom interpolation (measured in tests/core/frontend/klt_accuracy_test).
// Pixels are kept as 16-bit integers of 1/32 grey level and sums as integers: rounding is a tenth of what the camera's
// own 8 bits leave after the smoothing, a row of the patch is one 256-bit vector, and every vector width gives the
// same bits as the scalar reference, whatever the order of additions.
// Offsets in pixels. Views must be readable 2 pixels before the first pixel, and 20 columns / 3 rows past it and the
// size (ImagePyramid levels are, wherever the centre lies inside). Pure. O(patch area), no allocation.

#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/image.h"

namespace pelorus {

inline constexpr int kPatchStride = 16;
inline constexpr int kPatchMaxSize = 15;  // rows and columns in use
inline constexpr int kPatchPixels = kPatchStride * kPatchMaxSize;
inline constexpr int kPatchUnits = 32;  // per grey level

using PatchRows = std::array<std::int16_t, kPatchPixels>;

// After sampling: grey values and gradients. After normalise(): value is relative to mean, and all are zero where the
// mask is. What is told in grey levels below belongs to gradients made orthogonal to the constant and to the value, so
// that a comparison is blind to offset and gain of the light.
struct PatchTemplate {
  int size = 0;  // rows = columns in use; columns beyond it must be masked
  alignas(64) PatchRows value;
  alignas(64) PatchRows gradient_u;
  alignas(64) PatchRows gradient_v;
  alignas(64) PatchRows mask;  // -1: in use; 0: not
  int mean = 0;                // of the sampled values, in units
  float count = 0;             // pixels in use
  float energy = 0;            // sum of squared values about their mean
  float structure_uu = 0;      // sums of products of gradients
  float structure_uv = 0;
  float structure_vv = 0;
  float per_energy = 0;  // 1 / energy; 0 where there is none
  // Orthogonal gradient = stored gradient - offset - along * (value - value_offset); units.
  double per_count = 0;  // 1 / count
  double value_offset = 0;
  double offset_u = 0;
  double offset_v = 0;
  double along_u = 0;
  double along_v = 0;
};

// Sums of a template against an image patch I over the pixels in use, in grey levels.
struct PatchSums {
  float gradient_u = 0;  // sum of gradient_u * I
  float gradient_v = 0;
  float value = 0;   // sum of value * I
  float spread = 0;  // sum of squares of I about its mean
};

// Samples value and gradients of patch.size rows whose first pixel lies at (u, v) of the image.
void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch);

// The same where pixel (i, j) of the patch lies at (u, v) + A (i - c, j - c), c = (size - 1) / 2, A row-major.
// Gradients are along the patch's own axes. Near the identity the spline down the columns leans with the rows' shear,
// which changes values by less than the camera's noise and makes this three times faster. Positions outside the image
// are clamped to it and masked; the mask is left alone otherwise.
void sample_warped_patch(const ImageView& image, float u, float v, const std::array<float, 4>& A, PatchTemplate& patch);

// Removes the mean and fills what follows mean in the template.
void normalise(PatchTemplate& patch);

// Compares with the image patch whose first pixel lies at (u, v).
[[nodiscard]] PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch);

// How the image of a slanted surface shears and stretches along the row from one camera to the other: images of the
// change per slope du/dx and du/dy of the patch, about its centre. Along with gradient_u they form the normal equations
// of (shift, du/dx, du/dy), blind to offset and gain in the same way.
struct PatchSlant {
  static constexpr int kUnits = 4;  // per grey level
  alignas(64) PatchRows slope_x;
  alignas(64) PatchRows slope_y;
  // Upper triangle of the 3x3 matrix of sums of products: (uu, ux, uy, xx, xy, yy), grey levels.
  std::array<float, 6> structure{};
  double offset_x = 0;
  double offset_y = 0;
  double along_x = 0;
  double along_y = 0;
};
// Of a normalised template.
void prepare_slant(const PatchTemplate& patch, PatchSlant& slant);

struct SlantSums {
  PatchSums plain;
  float slope_x = 0;
  float slope_y = 0;
};
// compare_patch() with the two sums of the slant added.
[[nodiscard]] SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                              const PatchSlant& slant);

// What the sums say about the likeness of patch and template.
struct PatchFit {
  float spread = 0;    // sum of squares of the image patch about its mean; 0 when it shows nothing
  float ncc = 0;       // normalised correlation
  float per_gain = 0;  // contrast of the template over that of the image patch
};
inline constexpr float kMinPatchContrast = 0.05F;  // variance below which a patch shows nothing, grey levels^2
[[nodiscard]] inline PatchFit fit_of(const PatchTemplate& patch, const PatchSums& sums) {
  if (!(sums.spread > kMinPatchContrast * patch.count && patch.per_energy > 0)) return {};
  const float per_gain = 1.0F / std::sqrt(sums.spread * patch.per_energy);
  return {sums.spread, sums.value * patch.per_energy * per_gain, per_gain};
}

namespace reference {
// sample_warped_patch() without the lean.
void sample_each_pixel(const ImageView& image, float u, float v, const std::array<float, 4>& A, PatchTemplate& patch);
void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch);
void sample_warped_patch(const ImageView& image, float u, float v, const std::array<float, 4>& A, PatchTemplate& patch);
void normalise(PatchTemplate& patch);
[[nodiscard]] PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch);
void prepare_slant(const PatchTemplate& patch, PatchSlant& slant);
[[nodiscard]] SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                              const PatchSlant& slant);
}  // namespace reference

}  // namespace pelorus
