#pragma once
// Responses of the Hessian over place and filter size, and their local maxima: the detector half of SURF (Bay et al.
// 2008, sections 3.2-3.4). Filter sizes of octave o: 3 (2^(o+1) (i+1) + 1), i = 0..intervals-1; samples are
// sampling_step * 2^o pixels apart. A layer that a finer octave already holds is taken from there.
// Thread-bound. O(pixels); no allocation after construction.

#include <span>
#include <vector>

#include "core/frontend/surf.h"
#include "core/kernels/integral_image.h"

namespace pelorus {

// Responses of one filter size on a grid of samples: sample (i, j) sits at pixel (i * step, j * step).
struct ResponseLayer {
  int filter_size = 0;
  int step = 0;
  int width = 0;  // samples
  int height = 0;
  int stride = 0;
  // Samples whose filter lies inside the image; others hold zero.
  int first = 0;
  int last_u = -1;
  int last_v = -1;
  int same_as = -1;  // index of the layer of the finer octave with this filter size, or -1
  std::vector<float> response;

  [[nodiscard]] const float* row(int j) const { return response.data() + static_cast<std::ptrdiff_t>(j) * stride; }
  [[nodiscard]] float* row(int j) { return response.data() + static_cast<std::ptrdiff_t>(j) * stride; }
};

class SurfScaleSpace {
 public:
  SurfScaleSpace(const SurfConfig& config, int width, int height);

  // A maximum and the sample it was found at.
  struct Candidate {
    SurfPoint point;
    int filter_size = 0;
    int u = 0;
    int v = 0;
  };

  void build(const IntegralImage& integral);
  // Strongest config.max_points maxima over the threshold, ordered by response, then place; angle 0.
  [[nodiscard]] std::span<const SurfPoint> find_maxima(const IntegralImage& integral);

 private:
  void find_in(int octave, int interval);
  [[nodiscard]] bool searched_before(int octave, int interval) const;
  void keep_strongest(std::size_t wanted);
  void drop_weak();
  void drop_twins();
  [[nodiscard]] bool has_twin(const SurfPoint& point) const;
  [[nodiscard]] const ResponseLayer& layer(int octave, int interval) const;

  SurfConfig config_;
  std::vector<ResponseLayer> layers_;  // octave by octave
  std::vector<Candidate> candidates_;
  std::vector<SurfPoint> points_;
  std::vector<std::int32_t> columns_;  // of one row
  // Candidates by place, for drop_twins(): the latest of each cell, and for each candidate the one before it.
  int cell_columns_;
  int cell_rows_;
  std::vector<std::int32_t> latest_in_cell_;
  std::vector<std::int32_t> before_;
};

}  // namespace pelorus
