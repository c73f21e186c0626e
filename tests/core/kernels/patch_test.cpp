#include "core/kernels/patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/kernels/image_pyramid.h"
#include "tests/core/frontend/analytic_texture.h"
#include "tests/core/kernels/each_target.h"

namespace pelorus {
namespace {

ImagePyramid smooth_pyramid() {
  const test::AnalyticTexture texture(3);
  const Image image = test::render(texture, 120, 90, 1.0, 5, [](double u, double v) {
    return test::TexturePlace{u, v};
  });
  ImagePyramid pyramid;
  pyramid.build(image.view(), 1);
  return pyramid;
}

PatchTemplate empty_patch(int size) {
  PatchTemplate patch;
  patch.size = size;
  patch.value.fill(0), patch.gradient_u.fill(0), patch.gradient_v.fill(0), patch.mask.fill(0);
  for (int r = 0; r < size; ++r) {
    for (int c = 0; c < size; ++c) patch.mask[static_cast<std::size_t>(r * kPatchStride + c)] = -1;
  }
  return patch;
}

void expect_equal_bits(const PatchTemplate& a, const PatchTemplate& b) {
  const auto used = static_cast<std::ptrdiff_t>(a.size * kPatchStride);
  EXPECT_TRUE(std::equal(a.value.begin(), a.value.begin() + used, b.value.begin()));
  EXPECT_TRUE(std::equal(a.gradient_u.begin(), a.gradient_u.begin() + used, b.gradient_u.begin()));
  EXPECT_TRUE(std::equal(a.gradient_v.begin(), a.gradient_v.begin() + used, b.gradient_v.begin()));
  EXPECT_TRUE(std::equal(a.mask.begin(), a.mask.begin() + used, b.mask.begin()));
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.energy, b.energy);
  EXPECT_EQ(a.structure_uu, b.structure_uu);
  EXPECT_EQ(a.structure_uv, b.structure_uv);
  EXPECT_EQ(a.structure_vv, b.structure_vv);
}

TEST(Patch, VectorPathsEqualTheReferenceBitByBit) {
  const ImagePyramid pyramid = smooth_pyramid();
  for_each_target([&] {
    std::mt19937 rng(11);
    std::uniform_real_distribution<float> at(-8.0F, 75.0F);
    for (int i = 0; i < 200; ++i) {
      const int size = 5 + 2 * (i % 6);
      const float u = at(rng);
      const float v = at(rng);
      PatchTemplate patch = empty_patch(size);
      PatchTemplate expected = patch;
      sample_patch(pyramid.level(0), u, v, patch);
      reference::sample_patch(pyramid.level(0), u, v, expected);
      expect_equal_bits(patch, expected);
      normalise(patch);
      reference::normalise(expected);
      expect_equal_bits(patch, expected);
      const PatchSums sums = compare_patch(pyramid.level(0), v, u, patch);
      const PatchSums expected_sums = reference::compare_patch(pyramid.level(0), v, u, patch);
      EXPECT_EQ(sums.gradient_u, expected_sums.gradient_u);
      EXPECT_EQ(sums.gradient_v, expected_sums.gradient_v);
      EXPECT_EQ(sums.value, expected_sums.value);
      EXPECT_EQ(sums.spread, expected_sums.spread);
      PatchSlant slant;
      PatchSlant expected_slant;
      prepare_slant(patch, slant);
      reference::prepare_slant(patch, expected_slant);
      EXPECT_EQ(slant.structure, expected_slant.structure);
      const SlantSums slanted = compare_slanted_patch(pyramid.level(0), v, u, patch, slant);
      const SlantSums expected_slanted = reference::compare_slanted_patch(pyramid.level(0), v, u, patch, slant);
      EXPECT_EQ(slanted.plain.gradient_u, expected_sums.gradient_u);
      EXPECT_EQ(slanted.plain.spread, expected_sums.spread);
      EXPECT_EQ(slanted.slope_x, expected_slanted.slope_x);
      EXPECT_EQ(slanted.slope_y, expected_slanted.slope_y);
    }
  });
}

// Where the mask lets pixels through.
void expect_equal_pixels(const PatchTemplate& a, const PatchTemplate& b) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.size * kPatchStride); ++i) {
    ASSERT_EQ(a.mask[i], b.mask[i]);
    if (a.mask[i] == 0) continue;
    ASSERT_EQ(a.value[i], b.value[i]) << i;
    ASSERT_EQ(a.gradient_u[i], b.gradient_u[i]) << i;
    ASSERT_EQ(a.gradient_v[i], b.gradient_v[i]) << i;
  }
}

TEST(Patch, WarpedVectorPathsEqualTheReferenceBitByBit) {
  const ImagePyramid pyramid = smooth_pyramid();
  for_each_target([&] {
    std::mt19937 rng(12);
    std::uniform_real_distribution<float> at(2.0F, 85.0F);
    for (int i = 0; i < 400; ++i) {
      std::uniform_real_distribution<float> skew(-0.002F * static_cast<float>(i % 200),
                                                 0.002F * static_cast<float>(i % 200));
      const std::array<float, 4> A{1 + skew(rng), skew(rng), skew(rng), 1 + skew(rng)};
      const float u = at(rng);
      const float v = at(rng);
      PatchTemplate patch = empty_patch(5 + 2 * (i % 6));
      PatchTemplate expected = patch;
      sample_warped_patch(pyramid.level(0), u, v, A, patch);
      reference::sample_warped_patch(pyramid.level(0), u, v, A, expected);
      expect_equal_pixels(patch, expected);
    }
  });
}

TEST(Patch, SamplingInTwoPassesIsNearSamplingPixelByPixel) {
  const ImagePyramid pyramid = smooth_pyramid();
  std::mt19937 rng(13);
  std::uniform_real_distribution<float> skew(-0.12F, 0.12F);
  std::uniform_real_distribution<float> at(15.0F, 70.0F);
  double square = 0;
  double square_gradient = 0;
  int pixels = 0;
  for (int i = 0; i < 100; ++i) {
    const std::array<float, 4> A{1 + skew(rng), skew(rng), skew(rng), 1 + skew(rng)};
    PatchTemplate patch = empty_patch(15);
    PatchTemplate expected = patch;
    const float u = at(rng);
    const float v = at(rng);
    sample_warped_patch(pyramid.level(0), u, v, A, patch);
    reference::sample_each_pixel(pyramid.level(0), u, v, A, expected);
    for (std::size_t k = 0; k < kPatchPixels; ++k) {
      if (expected.mask[k] == 0) continue;
      ++pixels;
      square += std::pow(patch.value[k] - expected.value[k], 2);
      square_gradient += std::pow(patch.gradient_u[k] - expected.gradient_u[k], 2) +
                         std::pow(patch.gradient_v[k] - expected.gradient_v[k], 2);
    }
  }
  // Half of what noise of one grey level leaves after the spline.
  EXPECT_LT(std::sqrt(square / pixels) / kPatchUnits, 0.25);
  EXPECT_LT(std::sqrt(square_gradient / (2 * pixels)) / kPatchUnits, 0.25);
  std::printf("rms difference %.3f grey levels, of gradients %.3f\n", std::sqrt(square / pixels) / kPatchUnits,
              std::sqrt(square_gradient / (2 * pixels)) / kPatchUnits);
}

TEST(Patch, TheIdentityWarpSamplesThePlainPatch) {
  const ImagePyramid pyramid = smooth_pyramid();
  PatchTemplate plain = empty_patch(15);
  PatchTemplate warped = plain;
  sample_patch(pyramid.level(0), 40.25F - 7, 33.5F - 7, plain);
  sample_warped_patch(pyramid.level(0), 40.25F, 33.5F, {1, 0, 0, 1}, warped);
  for (std::size_t i = 0; i < kPatchPixels; ++i) {
    if (plain.mask[i] == 0) continue;
    EXPECT_NEAR(plain.value[i], warped.value[i], 1);  // rounding
    EXPECT_NEAR(plain.gradient_u[i], warped.gradient_u[i], 1);
    EXPECT_NEAR(plain.gradient_v[i], warped.gradient_v[i], 1);
  }
}

TEST(Patch, GradientsAreTheSlopeOfTheSampledValue) {
  const ImagePyramid pyramid = smooth_pyramid();
  constexpr float kStep = 0.125F;  // to either side; what rounding leaves of the quotient is 4 units
  const auto sampled = [&](float u, float v) {
    PatchTemplate patch = empty_patch(15);
    sample_patch(pyramid.level(0), 20.3F + u, 30.6F + v, patch);
    return patch;
  };
  const PatchTemplate at = sampled(0, 0);
  const PatchTemplate right = sampled(kStep, 0), left = sampled(-kStep, 0);
  const PatchTemplate below = sampled(0, kStep), above = sampled(0, -kStep);
  for (std::size_t i = 0; i < kPatchPixels; ++i) {
    EXPECT_NEAR(static_cast<float>(right.value[i] - left.value[i]) / (2 * kStep), at.gradient_u[i], 10.0F);
    EXPECT_NEAR(static_cast<float>(below.value[i] - above.value[i]) / (2 * kStep), at.gradient_v[i], 10.0F);
  }
}

TEST(Patch, ComparisonIsBlindToOffsetAndGainOfTheLight) {
  const test::AnalyticTexture texture(3);
  const auto place = [](double u, double v) { return test::TexturePlace{u, v}; };
  const Image plain = test::render(texture, 64, 64, 0.0, 1, place);
  const Image dimmed =
      test::render(texture, 64, 64, 0.0, 1, place, [](double grey, int, int) { return 0.5 * grey + 40; });
  ImagePyramid a;
  ImagePyramid b;
  a.build(plain.view(), 1);
  b.build(dimmed.view(), 1);
  PatchTemplate patch = empty_patch(15);
  sample_patch(a.level(0), 20.0F, 20.0F, patch);
  normalise(patch);
  const PatchSums same = compare_patch(b.level(0), 20.0F, 20.0F, patch);
  const PatchSums shifted = compare_patch(b.level(0), 21.0F, 20.0F, patch);
  EXPECT_LT(std::abs(same.gradient_u), 0.03F * std::abs(shifted.gradient_u));
  EXPECT_NEAR(same.value / patch.energy, 0.5F, 0.01F);
}

}  // namespace
}  // namespace pelorus
