#pragma once
// SURF of our own after Bay, Ess, Tuytelaars & Van Gool 2008 (paper 5.1): integral image, determinant of the
// box-filter Hessian, 3x3x3 non-maximum suppression with interpolated place and scale, 64-float descriptor of Haar
// responses, upright or with orientation. Descriptor windows overlap and are weighted as in M-SURF (Agrawal,
// Konolige & Blas 2008), and are sampled at real positions (core/kernels/cell_grid.h).
// Rectified pixels (u right, v down). Thread-bound: one object per thread; returned spans live until the next
// detect(). detect O(pixels), describe O(points); no allocation after construction.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/image.h"

namespace pelorus {

struct SurfConfig {
  int octaves = 3;          // 1..4
  int intervals = 4;        // filter sizes per octave, 3..5
  int sampling_step = 2;    // pixels between samples of the first octave: 1, 2 or 4; doubles with each octave
  float threshold = 10.0F;  // least determinant, grey levels^2
  // Turbid water dims all determinants alike: where their median is low, the least one is a third of it, down to this.
  float faint_threshold = 4.0F;
  bool upright = true;  // no orientation: for rigs that do not roll between images
  int max_points = 1500;
  // One blob answers in neighbouring filter sizes of two octaves: only the stronger answer is kept. Twins cost points
  // and fail the ratio test against each other.
  bool distinct = true;
};

struct SurfPoint {
  float u_px = 0;
  float v_px = 0;
  float scale = 0;      // sigma of the Gaussian the filter stands for, px
  float angle_rad = 0;  // from u towards v; 0 when upright
  float response = 0;   // interpolated determinant
  std::int8_t laplacian = 1;
};

using SurfDescriptor = std::array<float, 64>;  // unit length

class Surf {
 public:
  Surf(const SurfConfig& config, int width, int height);
  ~Surf();
  Surf(Surf&&) noexcept;
  Surf& operator=(Surf&&) noexcept;

  // The strongest max_points, ordered by response, then place. Orientation is assigned unless upright.
  [[nodiscard]] std::span<const SurfPoint> detect(const ImageView& image);

  // Descriptors of points in the image last given to detect(); any points, not only detected ones.
  void describe(std::span<const SurfPoint> points, std::span<SurfDescriptor> out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelorus
