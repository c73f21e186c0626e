#include "core/kernels/surf_patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/core/kernels/each_target.h"
#include "tests/core/kernels/random_image.h"

namespace pelorus {
namespace {

CellRows random_cells(unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> grey(0.0F, 255.0F);
  CellRows cells;
  for (float& c : cells) c = grey(rng);
  return cells;
}

float& cell(CellRows& cells, int i, int j) { return cells[static_cast<std::size_t>(j * kCellStride + i)]; }

TEST(SurfPatch, VectorPathsEqualTheReferenceBitByBit) {
  for_each_target([] {
    for (unsigned seed = 0; seed < 50; ++seed) {
      CellRows cells = random_cells(seed);
      std::array<float, 64> descriptor{};
      std::array<float, 64> expected{};
      describe_cells(cells, descriptor);
      reference::describe_cells(cells, expected);
      EXPECT_EQ(descriptor, expected);

      const float angle = 0.13F * static_cast<float>(seed);
      CellRows turned{};
      CellRows expected_turned{};
      rotate_cells(cells, std::cos(angle), std::sin(angle), turned);
      reference::rotate_cells(cells, std::cos(angle), std::sin(angle), expected_turned);
      for (int j = 0; j < kDescriptorCells; ++j) {
        for (int i = 0; i < kDescriptorCells; ++i) {
          ASSERT_EQ(cell(turned, i, j), cell(expected_turned, i, j)) << i << ' ' << j;
        }
      }
      const SurfDirection direction = dominant_direction(cells);
      const SurfDirection expected_direction = reference::dominant_direction(cells);
      EXPECT_EQ(direction.u, expected_direction.u);
      EXPECT_EQ(direction.v, expected_direction.v);
    }
  });
}

TEST(SurfPatch, ARampPointsUphillWhateverItsDirection) {
  for (int degrees = -175; degrees <= 180; degrees += 5) {
    const double angle = degrees * std::numbers::pi / 180;
    CellRows cells{};
    for (int j = 0; j < kOrientationCells; ++j) {
      for (int i = 0; i < kOrientationCells; ++i) {
        cell(cells, i, j) = static_cast<float>(100 + 3 * (std::cos(angle) * i + std::sin(angle) * j));
      }
    }
    const SurfDirection direction = dominant_direction(cells);
    const double found = std::atan2(static_cast<double>(direction.v), static_cast<double>(direction.u));
    EXPECT_NEAR(std::remainder(found - angle, 2 * std::numbers::pi), 0, 1e-3) << degrees;
  }
}

TEST(SurfPatch, ARampsDescriptorHasOneSignEverywhere) {
  CellRows cells{};
  for (int j = 0; j < kDescriptorCells; ++j) {
    for (int i = 0; i < kDescriptorCells; ++i) cell(cells, i, j) = static_cast<float>(10 + 2 * i - j);
  }
  std::array<float, 64> d{};
  describe_cells(cells, d);
  for (std::size_t w = 0; w < 16; ++w) {
    EXPECT_GT(d[4 * w], 0);
    EXPECT_NEAR(d[4 * w], d[4 * w + 1], 1e-6F);
    EXPECT_NEAR(d[4 * w + 2], -d[4 * w + 3], 1e-6F);
    EXPECT_NEAR(d[4 * w], -2 * d[4 * w + 2], 1e-6F);
  }
}

TEST(SurfPatch, TurningByTheMarkedAngleBringsTheRampBack) {
  const float angle = 0.8F;
  CellRows cells{};
  for (int j = 0; j < kRotatedCells; ++j) {
    for (int i = 0; i < kRotatedCells; ++i) {
      cell(cells, i, j) = 100 + 2 * (std::cos(angle) * static_cast<float>(i) + std::sin(angle) * static_cast<float>(j));
    }
  }
  CellRows turned{};
  rotate_cells(cells, std::cos(angle), std::sin(angle), turned);
  for (int j = 1; j < kDescriptorCells; ++j) {
    for (int i = 1; i < kDescriptorCells; ++i) {
      EXPECT_NEAR(cell(turned, i, j) - cell(turned, i - 1, j), 2.0F, 1e-3F);
      EXPECT_NEAR(cell(turned, i, j) - cell(turned, i, j - 1), 0.0F, 1e-3F);
    }
  }
}

TEST(SurfPatch, AFlatPatchHasAZeroDescriptor) {
  CellRows cells;
  cells.fill(77);
  std::array<float, 64> d{};
  describe_cells(cells, d);
  for (const float x : d) EXPECT_EQ(x, 0);
}

}  // namespace
}  // namespace pelorus
