#include "core/kernels/remap.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/core/kernels/each_target.h"
#include "tests/core/kernels/random_image.h"

namespace pelorus {
namespace {

TEST(Remap, VectorPathsEqualTheReferenceBitByBit) {
  for_each_target([] {
    std::mt19937 rng(5);
    const auto draw = [&](int least, int most) { return std::uniform_int_distribution<int>(least, most)(rng); };
    const Image raw = test::random_image(64, 40, 9);
    std::vector<RemapBlock> blocks(100);
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      RemapBlock& b = blocks[k];
      b.out_u = static_cast<std::int16_t>(kRemapBlock * (k % 10));
      b.out_v = static_cast<std::int16_t>(k / 10);
      b.u = static_cast<std::int16_t>(draw(0, 64 - kRemapWindowColumns));
      b.v = static_cast<std::int16_t>(draw(0, 40 - kRemapWindowRows));
      for (std::size_t i = 0; i < kRemapBlock; ++i) {
        b.column[i] = draw(0, 9) == 0 ? RemapBlock::kBlack : static_cast<std::uint8_t>(draw(0, 14));
        b.lower[i] = static_cast<std::int8_t>(-draw(0, 1));
        b.weight_u[i] = static_cast<std::uint8_t>(draw(0, 128));
        b.weight_v[i] = static_cast<std::uint8_t>(draw(0, 128));
      }
    }
    std::vector<std::uint8_t> out(10 * 80);
    std::vector<std::uint8_t> expected(10 * 80);
    remap(blocks, raw.view(), 80, out.data());
    reference::remap(blocks, raw.view(), 80, expected.data());
    EXPECT_EQ(out, expected);
  });
}

TEST(Remap, WholeWeightsCopyPixels) {
  const Image raw = test::random_image(32, 16, 2);
  RemapBlock block;
  block.u = 4, block.v = 7;
  for (std::size_t i = 0; i < kRemapBlock; ++i) {
    block.column[i] = static_cast<std::uint8_t>(i);
    block.lower[i] = static_cast<std::int8_t>(i % 2 == 0 ? 0 : -1);
    block.weight_u[i] = 128;  // the right neighbour alone
  }
  std::array<std::uint8_t, kRemapBlock> out{};
  remap({&block, 1}, raw.view(), kRemapBlock, out.data());
  for (int i = 0; i < kRemapBlock; ++i) EXPECT_EQ(out[static_cast<std::size_t>(i)], raw.row(7 + i % 2)[4 + i + 1]);
}

}  // namespace
}  // namespace pelorus
