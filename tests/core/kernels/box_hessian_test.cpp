#include "core/kernels/box_hessian.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/core/kernels/each_target.h"
#include "tests/core/kernels/random_image.h"

namespace pelorus {
namespace {

// The filter of Bay's figure 2, summed pixel by pixel.
double slow_response(const Image& image, int size, int u, int v) {
  const int lobe = size / 3;
  const auto sum = [&](int u0, int u1, int v0, int v1) {
    double s = 0;
    for (int y = v + v0; y <= v + v1; ++y) {
      for (int x = u + u0; x <= u + u1; ++x) s += image.row(y)[x];
    }
    return s;
  };
  const int reach = (size - 1) / 2;
  const int half = lobe / 2;
  const double area = size * size;
  const double xx = (sum(-reach, reach, 1 - lobe, lobe - 1) - 3 * sum(-half, half, 1 - lobe, lobe - 1)) / area;
  const double yy = (sum(1 - lobe, lobe - 1, -reach, reach) - 3 * sum(1 - lobe, lobe - 1, -half, half)) / area;
  const double xy =
      (sum(-lobe, -1, -lobe, -1) + sum(1, lobe, 1, lobe) - sum(1, lobe, -lobe, -1) - sum(-lobe, -1, 1, lobe)) / area;
  return xx * yy - 0.81 * xy * xy;
}

TEST(BoxHessian, ResponsesAreThoseOfTheFiltersSummedPixelByPixel) {
  const Image image = test::random_image(120, 110, 4);
  IntegralImage integral(120, 110, 2);
  integral.build(image.view());
  for (const int size : {9, 15, 27, 51}) {
    float response[16 + 3];
    const int reach = hessian_reach(size);
    hessian_row(integral, size, (reach + 1) / 2 * 2, reach + 3, 2, 3, response);
    for (int i = 0; i < 3; ++i) {
      const double expected = slow_response(image, size, (reach + 1) / 2 * 2 + 2 * i, reach + 3);
      EXPECT_NEAR(static_cast<double>(response[i]), expected, 1e-3 + 1e-4 * std::abs(expected)) << size;
    }
  }
}

TEST(BoxHessian, VectorPathsEqualTheReferenceBitByBitAtEveryStep) {
  const Image image = test::random_image(300, 120, 5);
  for (const int phases : {1, 2, 4}) {
    IntegralImage integral(300, 120, phases);
    integral.build(image.view());
    for_each_target([&] {
      for (int step = phases; step <= 8 * phases && step <= 16; step *= 2) {
        for (const int size : {9, 39, 75}) {
          const int first = (hessian_reach(size) + step - 1) / step * step;
          const int count = (299 - hessian_reach(size) - first) / step + 1;
          std::vector<float> response(static_cast<std::size_t>(count) + 16);
          std::vector<float> expected(response.size());
          hessian_row(integral, size, first, 50, step, count, response.data());
          reference::hessian_row(integral, size, first, 50, step, count, expected.data());
          response.resize(static_cast<std::size_t>(count));
          expected.resize(static_cast<std::size_t>(count));
          ASSERT_EQ(response, expected) << "phases " << phases << " step " << step << " size " << size;
        }
      }
    });
  }
}

TEST(BoxHessian, TheLaplacianTellsDarkBlobsFromBrightOnes) {
  Image dark(40, 40);
  Image bright(40, 40);
  for (int v = 0; v < 40; ++v) {
    for (int u = 0; u < 40; ++u) {
      const double blob = 100 * std::exp(-(std::pow(u - 20, 2) + std::pow(v - 20, 2)) / 18.0);
      dark.row(v)[u] = static_cast<std::uint8_t>(150 - blob);
      bright.row(v)[u] = static_cast<std::uint8_t>(50 + blob);
    }
  }
  IntegralImage integral(40, 40, 1);
  integral.build(dark.view());
  EXPECT_EQ(laplacian_sign(integral, 15, 20, 20), 1);
  integral.build(bright.view());
  EXPECT_EQ(laplacian_sign(integral, 15, 20, 20), -1);
}

}  // namespace
}  // namespace pelorus
