#include "core/kernels/cell_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/core/kernels/each_target.h"
#include "tests/core/kernels/random_image.h"

namespace pelorus {
namespace {

float cell(const CellRows& cells, int i, int j) { return cells[static_cast<std::size_t>(j * kCellStride + i)]; }

// Mean over [x0, x1) x [y0, y1) of the image as unit squares.
double slow_mean(const Image& image, double x0, double x1, double y0, double y1) {
  double sum = 0;
  for (int v = 0; v < image.height(); ++v) {
    const double h = std::max(0.0, std::min(y1, v + 1.0) - std::max(y0, 0.0 + v));
    for (int u = 0; h > 0 && u < image.width(); ++u) {
      sum += h * std::max(0.0, std::min(x1, u + 1.0) - std::max(x0, 0.0 + u)) * image.row(v)[u];
    }
  }
  return sum / ((x1 - x0) * (y1 - y0));
}

TEST(CellGrid, CellsAreMeansOverRealRectangles) {
  const Image image = test::random_image(150, 140, 6);
  IntegralImage integral(150, 140, 2);
  integral.build(image.view());
  CellRows cells;
  cell_means(integral, 11.37F, 20.81F, 2.43F, 35, cells);
  for (int j = 0; j < 35; ++j) {
    for (int i = 0; i < 35; ++i) {
      const double x = 11.37 + 2.43 * i;
      const double y = 20.81 + 2.43 * j;
      EXPECT_NEAR(static_cast<double>(cell(cells, i, j)), slow_mean(image, x, x + 2.43, y, y + 2.43), 0.05);
    }
  }
}

TEST(CellGrid, OutsideTheImageTheNearestCellIsRepeated) {
  const Image image = test::random_image(60, 50, 7);
  IntegralImage integral(60, 50, 1);
  integral.build(image.view());
  CellRows cells;
  cell_means(integral, -10.0F, 30.0F, 4.0F, 20, cells);
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 20; ++i) {
      const int inside_i = std::clamp(i, 2, 17);  // [-2, 2) shows half of itself, [58, 62) too
      const int inside_j = std::min(j, 4);
      EXPECT_EQ(cell(cells, i, j), cell(cells, inside_i, inside_j)) << i << ' ' << j;
    }
  }
}

TEST(CellGrid, VectorPathsFollowTheReference) {
  const Image image = test::random_image(200, 160, 8);
  for (const int phases : {1, 2, 4}) {
    IntegralImage integral(200, 160, phases);
    integral.build(image.view());
    for_each_target([&] {
      std::mt19937 rng(9);
      std::uniform_real_distribution<float> at(-60.0F, 180.0F);
      std::uniform_real_distribution<float> size(1.0F, 7.0F);
      for (int k = 0; k < 200; ++k) {
        const float x = at(rng);
        const float y = at(rng);
        const float s = size(rng);
        const int count = 15 + k % 21;
        CellRows cells;
        CellRows expected;
        cell_means(integral, x, y, s, count, cells);
        reference::cell_means(integral, x, y, s, count, expected);
        for (int j = 0; j < count; ++j) {
          for (int i = 0; i < count; ++i) {
            ASSERT_NEAR(cell(cells, i, j), cell(expected, i, j), 0.05F) << x << ' ' << y << ' ' << s;
          }
        }
      }
    });
  }
}

}  // namespace
}  // namespace pelorus
