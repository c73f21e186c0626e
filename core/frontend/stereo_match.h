#pragma once
// Left to right for points that have no prediction (paper 5.1: stereo pair of a new point): exhaustive search along
// the row of a rectified pair by normalised correlation on a coarse pyramid level, refused where a rival is nearly as
// good; sub-pixel refinement by the slanted row search of Klt down to full resolution; and the same from right to left,
// which must lead back. Disparity is u_left - u_right, px. Any number of threads may call match() of one object on
// disjoint tasks. O(tasks * disparities); no allocation.

#include <array>
#include <cstdint>
#include <span>

#include "core/frontend/klt.h"
#include "core/kernels/image_pyramid.h"

namespace pelorus {

struct StereoMatchConfig {
  float min_disparity_px = 0.0F;
  float max_disparity_px = 200.0F;
  int search_level = 2;           // pyramid level of the exhaustive search
  int search_half_window_px = 5;  // on that level; 2..7
  float min_ncc = 0.7F;           // of the exhaustive search; the refinement has Klt's own
  // Of (1 - ncc): best over best elsewhere. The coarse level is smooth, so rivals are seldom much worse.
  float max_rival_ratio = 0.8F;
  float max_return_px = 0.7F;  // right to left must lead back this near
};

enum class StereoOutcome : std::uint8_t { ok, no_match, ambiguous, inconsistent, out_of_image };
[[nodiscard]] const char* to_text(StereoOutcome outcome);

struct StereoTask {
  float u_left_px = 0;
  float v_px = 0;
  float u_right_px = 0;  // out, when ok
  float ncc = 0;         // out, at full resolution when ok, else of the search
  // Out, when ok: maps offsets in the left image to offsets in the right (KltTask::warp): the slant of the surface.
  // Worth keeping with the point: it serves the row search of later frames.
  std::array<float, 4> warp{1, 0, 0, 1};
  StereoOutcome outcome = StereoOutcome::no_match;
};

class StereoMatcher {
 public:
  static constexpr int kMaxCandidates = 512;  // disparities on the search level

  // Copies the tracker (it is configuration only).
  StereoMatcher(const StereoMatchConfig& config, const Klt& klt);

  void match(const ImagePyramid& left, const ImagePyramid& right, std::span<StereoTask> tasks) const;

 private:
  struct Found {
    StereoOutcome outcome = StereoOutcome::no_match;
    float u_px = 0;  // full resolution
    float ncc = 0;
    std::array<float, 4> warp{1, 0, 0, 1};
  };
  // direction +1: from left to right, partners lie left of the point; -1: from right to left.
  [[nodiscard]] Found search_row(const ImagePyramid& from, const ImagePyramid& to, float u_px, float v_px,
                                 int direction) const;
  [[nodiscard]] Found refine(const ImagePyramid& from, const ImagePyramid& to, float u_px, float v_px,
                             float u_predicted_px) const;
  [[nodiscard]] Found there(const ImagePyramid& from, const ImagePyramid& to, float u_px, float v_px,
                            int direction) const;

  StereoMatchConfig config_;
  Klt klt_;
};

}  // namespace pelorus
