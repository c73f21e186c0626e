#include "core/kernels/integral_image.h"

#include <gtest/gtest.h>

#include "tests/core/kernels/each_target.h"
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

TEST(IntegralImage, EveryInstructionSetEqualsTheReferenceBitByBit) {
  constexpr std::ptrdiff_t kStride = 80;
  std::vector<std::uint32_t> above(4 * kStride);
  for (std::size_t i = 0; i < above.size(); ++i) above[i] = static_cast<std::uint32_t>(i) * 0x9E3779B9U;  // wraps too
  for (const int phase_shift : {0, 1, 2}) {
    for (int width = 1; width <= 70; ++width) {
      const Image image = test::random_image(width, 1, static_cast<unsigned>(width));
      std::vector<std::uint32_t> expected(above.size(), 7);
      IntegralRow row{image.row(0), width, phase_shift, kStride, above.data(), expected.data()};
      reference::integral_row(row);
      for_each_target([&] {
        std::vector<std::uint32_t> got(above.size(), 7);
        row.out = got.data();
        integral_row(row);
        ASSERT_EQ(got, expected) << (1 << phase_shift) << " phases, width " << width;
      });
    }
  }
}

}  // namespace
}  // namespace pelorus
