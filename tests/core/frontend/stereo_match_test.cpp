#include "core/frontend/stereo_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/core/frontend/analytic_texture.h"

namespace pelorus {
namespace {

using test::AnalyticTexture;
using test::TexturePlace;

constexpr int kWidth = 400;
constexpr int kHeight = 200;

ImagePyramid pyramid_of(const Image& image) {
  ImagePyramid pyramid;
  pyramid.build(image.view(), 4);
  return pyramid;
}

struct Pair {
  ImagePyramid left;
  ImagePyramid right;
};

// A textured plane: disparity of the left pixel (u, v) is d0 + du * u + dv * v, so that right pixel u_r shows the left
// place u = (u_r + d0 + dv * v) / (1 - du).
struct Slant {
  double d0, du, dv;

  [[nodiscard]] double disparity(double u, double v) const { return d0 + du * u + dv * v; }
  [[nodiscard]] double left_of(double u_right, double v) const { return (u_right + d0 + dv * v) / (1 - du); }
};

Pair render_plane(const Slant& slant, double noise, double gain = 1.0) {
  const AnalyticTexture texture(17);
  const auto lit = [gain](double grey, int, int) { return 30 + gain * (grey - 30); };
  return {
      pyramid_of(test::render(texture, kWidth, kHeight, noise, 1,
                              [](double u, double v) {
                                return TexturePlace{u, v};
                              })),
      pyramid_of(test::render(
          texture, kWidth, kHeight, noise, 2,
          [&](double u, double v) {
            return TexturePlace{slant.left_of(u, v), v};
          },
          lit)),
  };
}

std::vector<StereoTask> grid(int left_margin_px) {
  std::vector<StereoTask> tasks;
  for (int v = 12; v < kHeight - 12; v += 13) {
    for (int u = left_margin_px; u < kWidth - 12; u += 17) {
      StereoTask task;
      task.u_left_px = static_cast<float>(u) + 0.37F;
      task.v_px = static_cast<float>(v) + 0.61F;
      tasks.push_back(task);
    }
  }
  return tasks;
}

struct Errors {
  double ok_share = 0;
  double gross_share = 0;  // of the ok ones, off by over a pixel
  double rms_px = 0;       // of the others
  double slope_rms = 0;    // of the warp's first row
};

Errors match_plane(const Slant& slant, double noise, double gain = 1.0) {
  const Pair pair = render_plane(slant, noise, gain);
  std::vector<StereoTask> tasks = grid(110);
  StereoMatcher({}, Klt({})).match(pair.left, pair.right, tasks);
  double square = 0;
  double slope_square = 0;
  int ok = 0;
  int gross = 0;
  for (const StereoTask& task : tasks) {
    if (task.outcome != StereoOutcome::ok) continue;
    ++ok;
    const double u = static_cast<double>(task.u_left_px);
    const double truth = u - slant.disparity(u, static_cast<double>(task.v_px));
    const double error = static_cast<double>(task.u_right_px) - truth;
    if (std::abs(error) > 1) {
      ++gross;
    } else {
      square += error * error;
      slope_square += std::pow(static_cast<double>(task.warp[0]) - (1 - slant.du), 2) +
                      std::pow(static_cast<double>(task.warp[1]) + slant.dv, 2);
    }
  }
  return {ok / static_cast<double>(tasks.size()), gross / std::max(1.0, static_cast<double>(ok)),
          std::sqrt(square / std::max(1, ok - gross)), std::sqrt(slope_square / std::max(1, 2 * (ok - gross)))};
}

TEST(StereoMatch, AFrontalPlaneIsFoundToASmallPartOfAPixel) {
  for (const double disparity : {1.3, 20.75, 77.4}) {
    const Errors errors = match_plane({disparity, 0, 0}, 1.0);
    EXPECT_GT(errors.ok_share, 0.85) << disparity;
    EXPECT_LT(errors.gross_share, 0.005) << disparity;
    EXPECT_LT(errors.rms_px, 0.03) << disparity;
  }
}

TEST(StereoMatch, ASlantedPlaneIsFound) {
  for (const Slant slant : {Slant{10, 0.08, 0.05}, Slant{60, -0.1, 0.1}, Slant{5, 0.02, 0.3}}) {
    const Errors errors = match_plane(slant, 1.0);
    EXPECT_GT(errors.ok_share, 0.75) << slant.du << ' ' << slant.dv;
    EXPECT_LT(errors.gross_share, 0.005) << slant.du << ' ' << slant.dv;
    EXPECT_LT(errors.rms_px, 0.04) << slant.du << ' ' << slant.dv;
    EXPECT_LT(errors.slope_rms, 0.02) << slant.du << ' ' << slant.dv;
  }
}

TEST(StereoMatch, AnotherExposureOnTheRightChangesNothing) {
  const Errors errors = match_plane({20.75, 0, 0}, 1.0, 0.6);
  EXPECT_GT(errors.ok_share, 0.8);
  EXPECT_LT(errors.gross_share, 0.005);
  EXPECT_LT(errors.rms_px, 0.04);
}

TEST(StereoMatch, ARepeatingPatternIsAmbiguous) {
  Image left(kWidth, kHeight);
  Image right(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const auto grey = [&](double x) {
        return static_cast<std::uint8_t>(std::lround(128 + 60 * std::sin(x * 0.26) + 30 * std::sin(v * 0.3)));
      };
      left.row(v)[u] = grey(u);
      right.row(v)[u] = grey(u + 9.5);
    }
  }
  std::vector<StereoTask> tasks = grid(110);
  StereoMatcher({}, Klt({})).match(pyramid_of(left), pyramid_of(right), tasks);
  for (const StereoTask& task : tasks) EXPECT_NE(task.outcome, StereoOutcome::ok);
}

TEST(StereoMatch, UnrelatedImagesHaveAlmostNoMatches) {
  const ImagePyramid left =
      pyramid_of(test::render(AnalyticTexture(1), kWidth, kHeight, 1.0, 1, [](double u, double v) {
        return TexturePlace{u, v};
      }));
  const ImagePyramid right =
      pyramid_of(test::render(AnalyticTexture(2), kWidth, kHeight, 1.0, 2, [](double u, double v) {
        return TexturePlace{u, v};
      }));
  std::vector<StereoTask> tasks = grid(110);
  StereoMatcher({}, Klt({})).match(left, right, tasks);
  int ok = 0;
  for (const StereoTask& task : tasks) ok += task.outcome == StereoOutcome::ok ? 1 : 0;
  EXPECT_LT(ok, static_cast<int>(tasks.size()) / 50);
}

TEST(StereoMatch, PointsOutsideOrWithoutAPartnerInViewAreRefused) {
  const Pair pair = render_plane({60, 0, 0}, 1.0);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<StereoTask> tasks;
  for (const float u : {-3.0F, 400.0F, kNan, 30.0F, 50.0F}) {
    StereoTask task;
    task.u_left_px = u;
    task.v_px = 100;
    tasks.push_back(task);
  }
  StereoTask below;
  below.u_left_px = 200;
  below.v_px = kNan;
  tasks.push_back(below);
  StereoMatcher({}, Klt({})).match(pair.left, pair.right, tasks);
  for (const StereoTask& task : tasks) EXPECT_NE(task.outcome, StereoOutcome::ok) << task.u_left_px;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(tasks[static_cast<std::size_t>(i)].outcome, StereoOutcome::out_of_image) << i;
  }
}

}  // namespace
}  // namespace pelorus
