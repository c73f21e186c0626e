// What a prediction may and may not do to Klt's answer.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/frontend/klt.h"
#include "tests/core/frontend/analytic_texture.h"

namespace pelorus {
namespace {

constexpr int kWidth = 256;
constexpr int kHeight = 192;
constexpr float kShiftU = 9.4F;
constexpr float kShiftV = -6.7F;

class KltPrediction : public testing::Test {
 protected:
  KltPrediction() {
    const test::AnalyticTexture texture(8);
    const auto shifted = [&](double du, double dv, unsigned seed) {
      return test::render(texture, kWidth, kHeight, 1.0, seed, [=](double u, double v) {
        return test::TexturePlace{u - du, v - dv};
      });
    };
    from_.build(shifted(0, 0, 1).view(), 4);
    to_.build(shifted(static_cast<double>(kShiftU), static_cast<double>(kShiftV), 2).view(), 4);
  }

  // Tasks whose prediction misses by (miss_u, miss_v), tracked.
  std::vector<KltTask> tracked(float miss_u, float miss_v, bool predicted) const {
    std::vector<KltTask> tasks;
    for (int v = 30; v < kHeight - 30; v += 17) {
      for (int u = 30; u < kWidth - 30; u += 17) {
        KltTask task;
        task.u_from_px = static_cast<float>(u) + 0.3F;
        task.v_from_px = static_cast<float>(v) + 0.6F;
        task.u_to_px = task.u_from_px + kShiftU + miss_u;
        task.v_to_px = task.v_from_px + kShiftV + miss_v;
        tasks.push_back(task);
      }
    }
    Klt({}).track(from_, to_, tasks, KltSearch::plane, 3, predicted);
    return tasks;
  }

  static double error_px(const KltTask& t) {
    return std::hypot(static_cast<double>(t.u_to_px - t.u_from_px - kShiftU),
                      static_cast<double>(t.v_to_px - t.v_from_px - kShiftV));
  }

  ImagePyramid from_;
  ImagePyramid to_;
};

TEST_F(KltPrediction, AGoodOneGivesTheSamePlaceAsTheWayThroughTheLevels) {
  const std::vector<KltTask> straight = tracked(0.7F, -0.5F, true);
  const std::vector<KltTask> through = tracked(0.7F, -0.5F, false);
  for (std::size_t i = 0; i < straight.size(); ++i) {
    ASSERT_EQ(straight[i].outcome, KltOutcome::ok);
    ASSERT_EQ(straight[i].level, 0);
    EXPECT_NEAR(straight[i].u_to_px, through[i].u_to_px, 0.01F);
    EXPECT_NEAR(straight[i].v_to_px, through[i].v_to_px, 0.01F);
  }
}

// Farther than full resolution alone can reach, or near another place that looks a little alike.
TEST_F(KltPrediction, AWrongOneIsNotBelieved) {
  for (const float miss : {4.0F, 8.0F, 13.0F}) {
    const std::vector<KltTask> straight = tracked(miss, 0.5F * miss, true);
    const std::vector<KltTask> through = tracked(miss, 0.5F * miss, false);
    int wrong = 0;
    int missing = 0;
    for (std::size_t i = 0; i < straight.size(); ++i) {
      wrong += straight[i].outcome == KltOutcome::ok && error_px(straight[i]) > 0.2;
      missing += straight[i].outcome != KltOutcome::ok && through[i].outcome == KltOutcome::ok;
    }
    EXPECT_EQ(wrong, 0) << miss;
    EXPECT_EQ(missing, 0) << miss;
  }
}

}  // namespace
}  // namespace pelorus
