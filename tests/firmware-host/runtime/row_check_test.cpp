#include "firmware-host/runtime/row_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/rectifier.h"
#include "drivers/replay/dataset.h"
#include "tests/support/real_data.h"

namespace pelorus {
namespace {

// Smooth texture without a period in the searched range.
double texture(double u, double v) {
  return 128 + 40 * std::sin(0.31 * u + 0.11 * v) + 40 * std::sin(0.23 * v - 0.07 * u) +
         25 * std::sin(0.013 * u * v / 9);
}

Image view_of_plane(double disparity_px, double row_offset_px) {
  Image image(320, 240);
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u)
      image.row(v)[u] =
          static_cast<std::uint8_t>(std::lround(std::clamp(texture(u + disparity_px, v - row_offset_px), 0.0, 255.0)));
  return image;
}

TEST(RowCheck, MeasuresAKnownOffsetToATenthOfAPixel) {
  const Image left = view_of_plane(0, 0);
  for (const double offset_px : {0.0, 0.4, -1.3, 2.25}) {
    const RowAgreement rows = measure_rows(left.view(), view_of_plane(9, offset_px).view());
    EXPECT_GT(rows.patches, 30);
    EXPECT_NEAR(rows.median_px, offset_px, 0.1);
    EXPECT_LT(rows.spread_px, 0.1);
  }
}

TEST(RowCheck, FindsNothingInImagesWithoutTexture) {
  Image faint = view_of_plane(0, 0);  // two gray levels of a real sensor are its noise
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) faint.row(v)[u] = static_cast<std::uint8_t>(100 + faint.row(v)[u] / 32);
  EXPECT_EQ(measure_rows(faint.view(), faint.view()).patches, 0);
}

TEST(RowCheck, OurRectificationAlignsTheRowsOfRealRawImages) {
  PELORUS_USE_REAL_DATA(path, "euroc/V1_01_easy_first40");
  auto source = open_dataset(path);
  ASSERT_TRUE(source.ok()) << source.error().message();
  const auto rectifier = Rectifier::create(source.value()->calibration(), "euroc");
  ASSERT_TRUE(rectifier.ok()) << rectifier.error().message();
  SourcePair pair;
  ASSERT_TRUE(source.value()->next(pair).value());
  Image left;
  Image right;
  rectifier.value().apply_left(pair.left.view(), left);
  rectifier.value().apply_right(pair.right.view(), right);
  const RowAgreement rows = measure_rows(left.view(), right.view());
  EXPECT_GT(rows.patches, 100);
  EXPECT_LT(std::abs(rows.median_px), 0.15);  // what the calibration itself is good for
  EXPECT_LT(rows.spread_px, 0.25);
  // The raw images are far from that: the check is able to fail.
  EXPECT_GT(measure_rows(pair.left.view(), pair.right.view()).spread_px, 0.5);
}

}  // namespace
}  // namespace pelorus
