#include "core/frontend/klt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include "tests/core/frontend/analytic_texture.h"

namespace pelorus {
namespace {

using test::AnalyticTexture;
using test::TexturePlace;

constexpr int kWidth = 256;
constexpr int kHeight = 192;

TexturePlace unmoved(double u, double v) { return {u, v}; }

ImagePyramid pyramid_of(const Image& image, int levels = 4) {
  ImagePyramid pyramid;
  pyramid.build(image.view(), levels);
  return pyramid;
}

// Points on a grid at fractional places, each predicted to stay.
std::vector<KltTask> grid(int margin_px) {
  std::vector<KltTask> tasks;
  for (int v = margin_px; v < kHeight - margin_px; v += 19) {
    for (int u = margin_px; u < kWidth - margin_px; u += 19) {
      KltTask task;
      task.u_from_px = static_cast<float>(u) + 0.01F * static_cast<float>((u * 7 + v) % 100);
      task.v_from_px = static_cast<float>(v) + 0.01F * static_cast<float>((u + v * 3) % 100);
      task.u_to_px = task.u_from_px;
      task.v_to_px = task.v_from_px;
      tasks.push_back(task);
    }
  }
  return tasks;
}

struct Errors {
  double rms_px = 0;  // per coordinate, of the points that are ok
  double ok_share = 0;
};

template <class Truth>
Errors errors_of(const std::vector<KltTask>& tasks, Truth&& truth) {
  double square = 0;
  int ok = 0;
  for (const KltTask& task : tasks) {
    if (task.outcome != KltOutcome::ok) continue;
    const TexturePlace t = truth(static_cast<double>(task.u_from_px), static_cast<double>(task.v_from_px));
    square +=
        std::pow(static_cast<double>(task.u_to_px) - t.u, 2) + std::pow(static_cast<double>(task.v_to_px) - t.v, 2);
    ++ok;
  }
  return {std::sqrt(square / std::max(1, 2 * ok)), ok / static_cast<double>(tasks.size())};
}

Errors track_shift(double du, double dv, double noise, unsigned seed) {
  const AnalyticTexture texture(seed);
  const ImagePyramid from = pyramid_of(test::render(texture, kWidth, kHeight, noise, seed + 1, unmoved));
  const ImagePyramid to = pyramid_of(test::render(texture, kWidth, kHeight, noise, seed + 2, [&](double u, double v) {
    return TexturePlace{u - du, v - dv};
  }));
  std::vector<KltTask> tasks = grid(24);
  Klt({}).track(from, to, tasks, KltSearch::plane, 3);
  return errors_of(tasks, [&](double u, double v) { return TexturePlace{u + du, v + dv}; });
}

// One grey level of noise in both images bounds any tracker: sigma = sqrt(2) / sqrt(225 * mean square gradient),
// about 0.01 px here. The limit leaves as much again for bias.
TEST(Klt, SubPixelShiftsAreFoundWithinTwoHundredths) {
  for (int i = 0; i < 10; ++i) {
    const Errors errors = track_shift(0.1 * i, 0.37 - 0.07 * i, 1.0, static_cast<unsigned>(i));
    EXPECT_LT(errors.rms_px, 0.02) << "shift " << i;
    EXPECT_EQ(errors.ok_share, 1.0) << "shift " << i;
  }
}

TEST(Klt, WithoutNoiseTheBiasStaysBelowFiveThousandths) {
  for (int i = 0; i < 5; ++i) EXPECT_LT(track_shift(0.2 * i + 0.05, 0.9 - 0.2 * i, 0.0, 40).rms_px, 0.005) << i;
}

TEST(Klt, LargeShiftsAreFoundFromTheCoarsestLevel) {
  const Errors errors = track_shift(13.4, -11.7, 1.0, 21);
  EXPECT_LT(errors.rms_px, 0.02);
  EXPECT_GT(errors.ok_share, 0.95);
}

TEST(Klt, AKnownRotationAndScaleIsRemovedByTheWarp) {
  const AnalyticTexture texture(4);
  const double angle = 0.35;
  const double scale = 1.15;
  const double a = scale * std::cos(angle);
  const double b = scale * std::sin(angle);
  const auto forward = [&](double u, double v) {
    return TexturePlace{a * (u - 128) - b * (v - 96) + 128.3, b * (u - 128) + a * (v - 96) + 95.6};
  };
  const auto backward = [&](double u, double v) {
    const double x = u - 128.3;
    const double y = v - 95.6;
    return TexturePlace{(a * x + b * y) / (scale * scale) + 128, (-b * x + a * y) / (scale * scale) + 96};
  };
  const ImagePyramid from = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 1, unmoved));
  const ImagePyramid to = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 2, backward));
  std::vector<KltTask> tasks = grid(50);
  for (KltTask& task : tasks) {
    const TexturePlace predicted = forward(static_cast<double>(task.u_from_px), static_cast<double>(task.v_from_px));
    task.u_to_px = static_cast<float>(predicted.u + 1.2);
    task.v_to_px = static_cast<float>(predicted.v - 0.8);
    task.warp = {static_cast<float>(a), static_cast<float>(-b), static_cast<float>(b), static_cast<float>(a)};
  }
  std::vector<KltTask> unwarped = tasks;
  for (KltTask& task : unwarped) task.warp = {1, 0, 0, 1};
  Klt({}).track(from, to, tasks, KltSearch::plane, 1);
  Klt({}).track(from, to, unwarped, KltSearch::plane, 1);
  const Errors errors = errors_of(tasks, forward);
  EXPECT_LT(errors.rms_px, 0.02);
  EXPECT_EQ(errors.ok_share, 1.0);
  EXPECT_LT(errors_of(unwarped, forward).ok_share, 0.9);  // the warp is what made it work
}

TEST(Klt, GainAndAMovingVignetteDoNotMoveThePoints) {
  const AnalyticTexture texture(6, 4.0, 0.5);
  const ImagePyramid from = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 1, unmoved));
  for (const double gain : {0.6, 0.8, 1.25, 1.6}) {
    const Image lit = test::render(
        texture, kWidth, kHeight, 1.0, 2,
        [](double u, double v) {
          return TexturePlace{u - 1.3, v + 0.45};
        },
        [&](double grey, int u, int v) {
          const double r2 = std::pow((u - 150) / 250.0, 2) + std::pow((v - 80) / 250.0, 2);
          return 20 + (grey - 20) * gain * (1 - 0.3 * r2) * 0.85;
        });
    std::vector<KltTask> tasks = grid(24);
    Klt({}).track(from, pyramid_of(lit), tasks, KltSearch::plane, 2);
    const Errors errors = errors_of(tasks, [](double u, double v) { return TexturePlace{u + 1.3, v - 0.45}; });
    EXPECT_LT(errors.rms_px, 0.06) << gain;
    EXPECT_GT(errors.ok_share, 0.97) << gain;
  }
}

TEST(Klt, RowSearchMovesAlongTheRowOnly) {
  const AnalyticTexture texture(8);
  const ImagePyramid left = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 1, unmoved));
  const ImagePyramid right = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 2, [](double u, double v) {
    return TexturePlace{u + 6.65, v};
  }));
  std::vector<KltTask> tasks = grid(30);
  Klt({}).track(left, right, tasks, KltSearch::row, 3);
  for (const KltTask& task : tasks) EXPECT_EQ(task.v_to_px, task.v_from_px);
  const Errors errors = errors_of(tasks, [](double u, double v) { return TexturePlace{u - 6.65, v}; });
  EXPECT_LT(errors.rms_px * std::sqrt(2.0), 0.02);
  EXPECT_GT(errors.ok_share, 0.99);
}

TEST(Klt, TrackingThereAndBackReturnsToTheStart) {
  const AnalyticTexture texture(9);
  const ImagePyramid a = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 1, unmoved));
  const ImagePyramid b = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 2, [](double u, double v) {
    return TexturePlace{u - 3.3, v - 2.2};
  }));
  std::vector<KltTask> tasks = grid(24);
  const Klt klt({});
  klt.track(a, b, tasks, KltSearch::plane, 3);
  for (KltTask& task : tasks) {
    ASSERT_EQ(task.outcome, KltOutcome::ok);
    KltTask back;
    back.u_from_px = task.u_to_px, back.v_from_px = task.v_to_px;
    back.u_to_px = task.u_to_px, back.v_to_px = task.v_to_px;
    klt.track(b, a, {&back, 1}, KltSearch::plane, 3);
    EXPECT_NEAR(back.u_to_px, task.u_from_px, 0.05F);
    EXPECT_NEAR(back.v_to_px, task.v_from_px, 0.05F);
  }
}

// Strong noise of the pixels: full resolution cannot reach the wanted correlation, one level up can.
TEST(Klt, WhenFullResolutionFailsTheCoarserAnswerStands) {
  const AnalyticTexture shape(10, 24.0);
  const Image a = test::render(shape, kWidth, kHeight, 14.0, 1, unmoved);
  const Image b = test::render(shape, kWidth, kHeight, 14.0, 2, [](double u, double v) {
    return TexturePlace{u - 2.5, v - 1.5};
  });
  KltConfig config;
  config.min_ncc = config.confirmed_ncc = 0.97F;
  std::vector<KltTask> tasks = grid(40);
  Klt(config).track(pyramid_of(a), pyramid_of(b), tasks, KltSearch::plane, 3);
  int fallen_back = 0;
  for (const KltTask& task : tasks) {
    if (task.outcome != KltOutcome::ok || task.level == 0) continue;
    ++fallen_back;
    EXPECT_NEAR(task.u_to_px - task.u_from_px, 2.5F, 1.0F);
    EXPECT_NEAR(task.v_to_px - task.v_from_px, 1.5F, 1.0F);
  }
  EXPECT_GT(fallen_back, static_cast<int>(tasks.size()) / 2);
}

TEST(Klt, ForeignTextureIsRefused) {
  const ImagePyramid a = pyramid_of(test::render(AnalyticTexture(1), kWidth, kHeight, 1.0, 1, unmoved));
  const ImagePyramid b = pyramid_of(test::render(AnalyticTexture(2), kWidth, kHeight, 1.0, 2, unmoved));
  std::vector<KltTask> tasks = grid(24);
  Klt({}).track(a, b, tasks, KltSearch::plane, 0);
  EXPECT_LT(errors_of(tasks, unmoved).ok_share, 0.05);
  for (const KltTask& task : tasks) {
    if (task.outcome == KltOutcome::ok) continue;
    EXPECT_EQ(task.u_to_px, task.u_from_px);
  }
}

TEST(Klt, FlatImagesAreLowTexture) {
  Image flat(kWidth, kHeight);
  const ImagePyramid pyramid = pyramid_of(flat);
  std::vector<KltTask> tasks = grid(24);
  Klt({}).track(pyramid, pyramid, tasks, KltSearch::plane, 3);
  for (const KltTask& task : tasks) EXPECT_EQ(task.outcome, KltOutcome::low_texture);
}

TEST(Klt, PointsAtTheEdgeAreTrackedAndThoseOutsideRefused) {
  const AnalyticTexture texture(14);
  const ImagePyramid a = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 1, unmoved));
  const ImagePyramid b = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 2, [](double u, double v) {
    return TexturePlace{u - 0.6, v - 0.4};
  }));
  const auto at = [](float u, float v) {
    KltTask task;
    task.u_from_px = task.u_to_px = u;
    task.v_from_px = task.v_to_px = v;
    return task;
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  std::vector<KltTask> edge{at(2, 100), at(253, 100), at(100, 2), at(100, 189), at(4.5F, 5.5F)};
  std::vector<KltTask> outside{at(-1, 100), at(256, 100), at(kNan, 5), at(5, kNan), at(kInf, -kInf), at(1e30F, 1)};
  outside.push_back(at(50, 50));
  outside.back().warp = {kNan, 0, 0, 1};
  outside.push_back(at(50, 50));
  outside.back().u_to_px = kNan;
  Klt({}).track(a, b, edge, KltSearch::plane, 3);
  Klt({}).track(a, b, outside, KltSearch::plane, 3);
  for (const KltTask& task : edge) {
    EXPECT_EQ(task.outcome, KltOutcome::ok) << task.u_from_px << ' ' << task.v_from_px;
    EXPECT_NEAR(task.u_to_px, task.u_from_px + 0.6F, 0.1F);
    EXPECT_NEAR(task.v_to_px, task.v_from_px + 0.4F, 0.1F);
  }
  for (const KltTask& task : outside) EXPECT_NE(task.outcome, KltOutcome::ok);
}

TEST(Klt, TwoThreadsOnHalvesGiveTheSameBits) {
  const AnalyticTexture texture(15);
  const ImagePyramid a = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 1, unmoved));
  const ImagePyramid b = pyramid_of(test::render(texture, kWidth, kHeight, 1.0, 2, [](double u, double v) {
    return TexturePlace{u - 4.6, v - 3.4};
  }));
  std::vector<KltTask> whole = grid(10);
  std::vector<KltTask> halves = whole;
  const Klt klt({});
  klt.track(a, b, whole, KltSearch::plane, 3);
  const std::size_t middle = halves.size() / 2;
  std::thread other([&] { klt.track(a, b, std::span(halves).subspan(middle), KltSearch::plane, 3); });
  klt.track(a, b, std::span(halves).first(middle), KltSearch::plane, 3);
  other.join();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(whole[i].u_to_px, halves[i].u_to_px);
    EXPECT_EQ(whole[i].v_to_px, halves[i].v_to_px);
    EXPECT_EQ(whole[i].outcome, halves[i].outcome);
  }
}

// The covariance a caller forms from structure and residual must be that of the actual errors.
TEST(Klt, StructureAndResidualPredictTheScatter) {
  double normalised_square = 0;
  int count = 0;
  for (unsigned seed = 0; seed < 5; ++seed) {
    const AnalyticTexture texture(seed, 8.0, 0.3);
    const ImagePyramid a = pyramid_of(test::render(texture, kWidth, kHeight, 2.0, seed + 50, unmoved));
    const ImagePyramid b = pyramid_of(test::render(texture, kWidth, kHeight, 2.0, seed + 60, [](double u, double v) {
      return TexturePlace{u - 0.5, v - 0.25};
    }));
    std::vector<KltTask> tasks = grid(24);
    Klt({}).track(a, b, tasks, KltSearch::plane, 1);
    for (const KltTask& task : tasks) {
      if (task.outcome != KltOutcome::ok || task.level > 0) continue;
      const double eu = static_cast<double>(task.u_to_px - task.u_from_px) - 0.5;
      const double ev = static_cast<double>(task.v_to_px - task.v_from_px) - 0.25;
      const double quadratic = eu * eu * static_cast<double>(task.structure[0]) +
                               2 * eu * ev * static_cast<double>(task.structure[1]) +
                               ev * ev * static_cast<double>(task.structure[2]);
      normalised_square += quadratic * 225 / std::pow(static_cast<double>(task.residual_rms), 2);
      ++count;
    }
  }
  const double factor = normalised_square / (2.0 * count);  // 1 if residuals were white and gradients exact
  RecordProperty("factor", std::to_string(factor));
  EXPECT_GT(factor, 0.7);
  EXPECT_LT(factor, 2.2);
}

}  // namespace
}  // namespace pelorus
