#pragma once
// Pyramidal point tracker of our own (paper 5.1; Lucas & Kanade 1981, Bouguet 2000, inverse-compositional form of
// Baker & Matthews 2004). Differences from the textbook: patches are compared up to offset and gain, since under
// water the light is carried by the vehicle; normalised correlation (NCC) is checked on every level; and when a
// level fails, the best level below it stands (KltTask::level) instead of the point being dropped.
// Rectified pixels (u right, v down). Any number of threads may call track() of one object on disjoint tasks;
// results do not depend on the split. O(tasks * levels * iterations * window); no allocation, ~4 kB of stack.

#include <array>
#include <cstdint>
#include <span>

#include "core/kernels/image_pyramid.h"

namespace pelorus {

enum class KltOutcome : std::uint8_t { ok, out_of_image, low_texture, diverged, low_correlation };
[[nodiscard]] const char* to_text(KltOutcome outcome);

struct KltConfig {
  int half_window_px = 7;  // 15 x 15; 2..7
  int levels = 4;          // of the pyramids the caller builds; coarser starts than levels - 1 are clipped
  int max_iterations = 12;
  float epsilon_px = 0.005F;  // last step at full resolution; coarser levels stop earlier
  float min_ncc = 0.85F;
  float confirmed_ncc = 0.75F;  // where a coarser level already found the same place
  float min_eigenvalue = 0.3F;  // of the structure tensor per pixel, grey levels^2 / px^2
};

// One point to carry.
struct KltTask {
  float u_from_px = 0;  // in `from`
  float v_from_px = 0;
  float u_to_px = 0;  // in: predicted place in `to`; out: tracked place; untouched unless the outcome is ok
  float v_to_px = 0;
  // Row-major 2x2 that maps offsets in `from` to offsets in `to`; given, and changed by the slanted row search only.
  std::array<float, 4> warp{1, 0, 0, 1};
  float ncc = 0;  // at the finest level that succeeded, else of the last attempt
  // Grey levels of `to` on that level after offset and gain are removed, referred to raw pixels (sampling smooths
  // noise; undone). With white noise of sigma in both images: sqrt(2) sigma.
  float residual_rms = 0;
  // Structure tensor (uu, uv, vv) per pixel on that level, in grey levels^2 per full-resolution px^2, of the
  // gradients that are blind to offset and gain. The covariance of (u, v) is about
  // residual_rms^2 / (pixels of the window) * inverse(structure), in px^2 of full resolution.
  std::array<float, 3> structure{};
  int level = 0;  // finest level that succeeded; 0 = full resolution
  KltOutcome outcome = KltOutcome::out_of_image;
};

// row: only u moves (stereo along the row). slanted_row: also estimates the first row of the warp at full resolution,
// which a surface that is not seen face on needs: at a disparity slope of 0.1 the plain row search errs by 0.1..0.2 px.
enum class KltSearch : std::uint8_t { plane, row, slanted_row };

class Klt {
 public:
  explicit Klt(const KltConfig& config);

  // coarsest_level: where to start; a good prediction allows a low one. `predicted` tasks are tried at full resolution
  // first and go through the coarser levels only where that does not confirm the prediction to about a pixel.
  void track(const ImagePyramid& from, const ImagePyramid& to, std::span<KltTask> tasks, KltSearch search,
             int coarsest_level, bool predicted = false) const;

  [[nodiscard]] const KltConfig& config() const { return config_; }

 private:
  KltConfig config_;
};

}  // namespace pelorus
