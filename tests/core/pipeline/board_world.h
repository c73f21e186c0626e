#pragma once
// A camera that moves to the right in front of a textured plane, with or without a board that moves between them.

#include <algorithm>
#include <cmath>

#include "core/base/image.h"
#include "core/geometry/stereo_rig.h"
#include "tests/core/frontend/analytic_texture.h"

namespace pelorus::test {

inline constexpr int kWidth = 320;
inline constexpr int kHeight = 240;
inline constexpr double kDisparity_px = 10.0;
inline constexpr double kFlow_px = 2.5;
inline const StereoRig kBoardRig{kWidth, kHeight, 250.0, 159.5, 119.5, 0.12};  // the plane is at 3 m, a step 30 mm

struct StereoImages {
  Image left;
  Image right;
};

// The camera moves to the right in front of a textured plane that faces it.
inline StereoImages plane(int frame) {
  const AnalyticTexture texture(11);
  const double shift = kFlow_px * frame;
  const auto seed = static_cast<unsigned>(10 * frame);
  return {render(texture, kWidth, kHeight, 1.0, seed + 1,
                 [&](double u, double v) {
                   return TexturePlace{u + shift, v};
                 }),
          render(texture, kWidth, kHeight, 1.0, seed + 2, [&](double u, double v) {
            return TexturePlace{u + shift + kDisparity_px, v};
          })};
}

// In front of it, at 2 m, a board of its own texture that rests up to `starts` and then moves to the right with
// `mm_per_frame2` of acceleration, up to 8 mm per frame.
struct Board {
  int starts = 0;
  double mm_per_frame2 = 8;
  double offset_m = 0;

  [[nodiscard]] double place_m(int frame) const {
    double place_mm = 1000 * offset_m;
    for (int k = starts; k < frame; ++k) place_mm += std::min(8.0, mm_per_frame2 * (k - starts + 1));
    return place_mm / 1000;
  }
  [[nodiscard]] double shift_px(int frame) const { return kBoardRig.f_px * (0.03 * frame - place_m(frame)) / 2.0; }
};

inline StereoImages plane_with_board(int frame, const Board& board) {
  const AnalyticTexture front(12);
  const auto view = [&](double disparity_of_plane, double disparity_of_board, unsigned seed) {
    return render(front, kWidth, kHeight, 1.0, seed, [&](double u, double v) {
      const double u_board = u + board.shift_px(frame) + disparity_of_board;
      // The board spans 110 by 90 px of its own texture; elsewhere the plane shows a far part of the same texture.
      if (std::abs(u_board - 190) < 55 && std::abs(v - 120) < 45) return TexturePlace{u_board, v};
      return TexturePlace{u + kFlow_px * frame + disparity_of_plane + 5000, v + 3000};
    });
  };
  const auto seed = static_cast<unsigned>(10 * frame);
  return {view(0, 0, seed + 1), view(kDisparity_px, kBoardRig.f_px * kBoardRig.baseline_m / 2.0, seed + 2)};
}

inline StereoImages grey() {
  StereoImages images{Image(kWidth, kHeight), Image(kWidth, kHeight)};
  for (Image* image : {&images.left, &images.right}) {
    for (int v = 0; v < kHeight; ++v) std::fill_n(image->row(v), kWidth, std::uint8_t{128});
  }
  return images;
}

}  // namespace pelorus::test
