#pragma once
// Inner loops of patch tracking: sub-pixel sampling of a square patch with gradients, normalisation of a template
// against light (mean and gain), and its comparison with another image.
// Sampling uses the cubic B-spline without prefilter: both images are seen through the same slight smoothing
// (1 4 1)/6, which leaves so little aliasing that the sub-pixel bias of the tracker is several times below that of
// linear or Catmull-Rom interpolation (measured in tests/core/frontend/klt_accuracy_test).
// Patches hold rows of kPatchStride floats; sums run per column first and then over columns in a fixed order, so
// that every vector width gives the same bits as the scalar reference. Grey levels 0..255, offsets in pixels.
// Views must be readable 2 pixels before the first pixel, and 20 columns / 3 rows past it and the size (ImagePyramid
// levels are, wherever the centre lies inside). Pure. O(patch area), no allocation.

#include <array>

#include "core/base/image.h"

namespace pelorus {

inline constexpr int kPatchStride = 16;
inline constexpr int kPatchMaxSize = 15;  // rows and columns in use
inline constexpr int kPatchFloats = kPatchStride * kPatchMaxSize;

using PatchRows = std::array<float, kPatchFloats>;

// After sampling: grey values and gradients. After normalise(): value has mean zero; gradients are orthogonal to
// the constant and to the value, so that a comparison is blind to offset and gain of the light; both are zero
// where weight is zero.
struct PatchTemplate {
  int size = 0;  // rows = columns in use; columns beyond it must have weight 0
  alignas(64) PatchRows value;
  alignas(64) PatchRows gradient_u;
  alignas(64) PatchRows gradient_v;
  alignas(64) PatchRows weight;  // 0 or 1
  float mean = 0;                // of the sampled values
  float count = 0;               // pixels of weight 1
  float energy = 0;              // sum of squared normalised values
  float structure_uu = 0;        // sums of products of normalised gradients
  float structure_uv = 0;
  float structure_vv = 0;
};

// Sums of a template against an image patch I, over pixels of weight 1; I is taken relative to the template's mean.
struct PatchSums {
  float gradient_u = 0;  // sum of gradient_u * I
  float gradient_v = 0;
  float value = 0;  // sum of value * I
  float sum = 0;    // sum of I
  float square = 0;
};

// Samples value and gradients of patch.size rows whose first pixel lies at (u, v) of the image.
void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch);

// The same where pixel (i, j) of the patch lies at (u, v) + A (i - c, j - c), c = (size - 1) / 2, A row-major.
// Gradients are along the patch's own axes. Positions outside the image are clamped to it and get weight 0;
// weights are left alone otherwise.
void sample_warped_patch(const ImageView& image, float u, float v, const std::array<float, 4>& A, PatchTemplate& patch);

// Removes the mean, makes gradients orthogonal to constant and value, and fills the sums of the template.
void normalise(PatchTemplate& patch);

// Compares with the image patch whose first pixel lies at (u, v).
[[nodiscard]] PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch);

// How the image of a slanted surface shears and stretches along the row from one camera to the other: images of the
// change per slope du/dx and du/dy of the patch, about its centre, orthogonal to the constant and to the value. Along
// with gradient_u they form the normal equations of (shift, du/dx, du/dy).
struct PatchSlant {
  alignas(64) PatchRows slope_x;
  alignas(64) PatchRows slope_y;
  // Upper triangle of the 3x3 matrix of sums of products: (uu, ux, uy, xx, xy, yy).
  std::array<float, 6> structure{};
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
  float spread = 0;  // sum of squares of the image patch about its mean; 0 when it shows nothing
  float ncc = 0;     // normalised correlation
};
inline constexpr float kMinPatchContrast = 0.05F;  // variance below which a patch shows nothing, grey levels^2
[[nodiscard]] PatchFit fit_of(const PatchTemplate& patch, const PatchSums& sums);

namespace reference {
void sample_patch(const ImageView& image, float u, float v, PatchTemplate& patch);
void sample_warped_patch(const ImageView& image, float u, float v, const std::array<float, 4>& A, PatchTemplate& patch);
void normalise(PatchTemplate& patch);
[[nodiscard]] PatchSums compare_patch(const ImageView& image, float u, float v, const PatchTemplate& patch);
void prepare_slant(const PatchTemplate& patch, PatchSlant& slant);
[[nodiscard]] SlantSums compare_slanted_patch(const ImageView& image, float u, float v, const PatchTemplate& patch,
                                              const PatchSlant& slant);
}  // namespace reference

}  // namespace pelorus
