// No heap on the per-frame path of the front end's classes once they are warm.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/frontend/front_end.h"
#include "tests/core/frontend/analytic_texture.h"
#include "tests/support/allocation_count.h"

namespace pelorus {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kLevels = 4;
constexpr int kDisparityPx = 17;

// Windows of one large texture: what a camera sees that drifts along it.
class Scenery {
 public:
  Scenery()
      : image_(test::render(test::AnalyticTexture(7), 3 * kWidth, 2 * kHeight, 1.0, 3, [](double u, double v) {
          return test::TexturePlace{u, v};
        })) {}

  [[nodiscard]] ImageView left(int step) const { return window(60 + 3 * step, 100 - 2 * step); }
  [[nodiscard]] ImageView right(int step) const { return window(60 + 3 * step + kDisparityPx, 100 - 2 * step); }

 private:
  [[nodiscard]] ImageView window(int u, int v) const { return {image_.row(v) + u, kWidth, kHeight, image_.stride()}; }
  Image image_;
};

std::vector<KltTask> grid_of_tasks(int shift_px) {
  std::vector<KltTask> tasks;
  for (int v = 30; v < kHeight - 30; v += 12) {
    for (int u = 50; u < kWidth - 50; u += 12) {
      tasks.push_back(task_between(u, v, u - shift_px, v));
    }
  }
  return tasks;
}

class FrontEndHeap : public testing::Test {
 protected:
  void SetUp() override {
    if (!PELORUS_COUNTS_ALLOCATIONS) GTEST_SKIP() << "a sanitizer's allocator cannot be counted";
  }
  Scenery scenery_;
};

TEST_F(FrontEndHeap, TheCounterSeesAllocations) {  // or the others would prove nothing
  std::vector<int> grows;
  EXPECT_GE(test::allocations_in([&] { grows.resize(scenery_.left(0).pixels[0] + 1U); }), 1);
  EXPECT_GE(test::allocations_in([] { const Image image(64, 64); }), 1);
}

TEST_F(FrontEndHeap, PyramidAndKltTakeNone) {
  ImagePyramid from(kWidth, kHeight, kLevels);
  ImagePyramid to(kWidth, kHeight, kLevels);
  const Klt klt({});
  std::vector<KltTask> tasks = grid_of_tasks(0);
  std::vector<KltTask> across = grid_of_tasks(kDisparityPx);
  for (KltTask& task : across) task.warp = {1.02F, 0.03F, 0, 1};
  EXPECT_EQ(test::allocations_in([&] {
              from.build(scenery_.left(0), kLevels);
              to.build(scenery_.left(1), kLevels);
              klt.track(from, to, tasks, KltSearch::plane, 3);
              to.build(scenery_.right(0), kLevels);
              klt.track(from, to, across, KltSearch::row, 1);
              klt.track(from, to, across, KltSearch::slanted_row, 1);
            }),
            0);
  EXPECT_GT(std::count_if(tasks.begin(), tasks.end(), [](const KltTask& t) { return t.outcome == KltOutcome::ok; }),
            100);
}

TEST_F(FrontEndHeap, StereoMatcherTakesNone) {
  ImagePyramid left(kWidth, kHeight, kLevels);
  ImagePyramid right(kWidth, kHeight, kLevels);
  left.build(scenery_.left(0), kLevels);
  right.build(scenery_.right(0), kLevels);
  const StereoMatcher matcher({}, Klt({}));
  std::vector<StereoTask> tasks;
  for (const KltTask& t : grid_of_tasks(0)) tasks.push_back({.u_left_px = t.u_from_px, .v_px = t.v_from_px});
  EXPECT_EQ(test::allocations_in([&] { matcher.match(left, right, tasks); }), 0);
  EXPECT_GT(
      std::count_if(tasks.begin(), tasks.end(), [](const StereoTask& t) { return t.outcome == StereoOutcome::ok; }),
      50);
}

TEST_F(FrontEndHeap, SurfAndItsMatcherTakeNone) {
  for (const bool upright : {true, false}) {
    SurfConfig config;
    config.threshold = 1.0F;
    config.max_points = 200;  // fewer than there are: the weakest are dropped on the way
    config.upright = upright;
    Surf surf(config, kWidth, kHeight);
    SurfMatcher matcher({});
    std::vector<SurfDescriptor> before(200);
    std::vector<SurfDescriptor> now(200);
    const auto found = surf.detect(scenery_.left(0));
    const std::vector<SurfPoint> points(found.begin(), found.end());
    surf.describe(points, before);
    std::size_t matches = 0;
    EXPECT_EQ(test::allocations_in([&] {
                const auto again = surf.detect(scenery_.left(1));
                surf.describe(again, now);
                matches = matcher.match(points, before, again, now, 40.0F).size();
              }),
              0);
    EXPECT_GT(matches, 50U);
  }
}

TEST_F(FrontEndHeap, TheFrontEndTakesNoneAfterWarmUpNotEvenWhenTheViewJumps) {
  FrontEndConfig config;
  config.max_points = 150;
  const StereoRig rig{kWidth, kHeight, 300.0, kWidth / 2.0, kHeight / 2.0, 0.1};
  InlineWorker inline_worker;
  FrontEnd front_end(config, rig, {inline_worker, inline_worker});
  const BodyPrediction still{kWorldBody, Rigid3::Identity()};
  std::vector<BodyId> bodies(1000, kWorldBody);
  int pairs = 0;
  for (int k = 0; k < 20; ++k) {
    const int step = k < 14 ? k : k + 16;  // a jump of fifty pixels at frame 14
    StereoFrame frame;
    frame.left = scenery_.left(step);
    frame.right = scenery_.right(step);
    const long count = test::allocations_in([&] {
      const PointPairs found = front_end.run(frame, {&still, 1});
      pairs = static_cast<int>(found.size());
      front_end.settle(std::span(bodies).first(found.size()), {&still, 1});
      front_end.refill({}, false);
    });
    EXPECT_TRUE(k < 2 || count == 0) << count << " in frame " << k;
    EXPECT_TRUE(k != 14 || front_end.counts().bridged > 0);
  }
  EXPECT_GT(pairs, 30);
}

}  // namespace
}  // namespace pelorus
