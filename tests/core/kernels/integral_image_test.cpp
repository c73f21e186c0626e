#include "core/kernels/integral_image.h"

#include <gtest/gtest.h>

#include "tests/core/kernels/random_image.h"

namespace pelorus {
namespace {

TEST(IntegralImage, EveryEntryIsTheSumAboveAndLeftForEveryPhaseLayout) {
  for (const int phases : {1, 2, 4}) {
    for (const int width : {1, 2, 3, 37, 64}) {
      const Image image = test::random_image(width, 23, 3);
      IntegralImage integral(width, 23, phases);
      integral.build(image.view());
      for (int y = 0; y <= 23; ++y) {
        std::uint32_t row_sum = 0;
        for (int x = 0; x <= width; ++x) {
          if (x > 0) {
            for (int v = 0; v < y; ++v) row_sum += image.row(v)[x - 1];
          }
          ASSERT_EQ(integral.at(x, y), row_sum) << phases << " phases, width " << width << ": " << x << ' ' << y;
        }
      }
    }
  }
}

}  // namespace
}  // namespace pelorus
