#include "core/frontend/front_end.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/side_worker.h"
#include "tests/core/pipeline/board_world.h"

namespace pelorus {
namespace {

using test::kBoardRig;
using test::kDisparity_px;
using test::kFlow_px;
using test::StereoImages;

// The front end alone, shown a plane past which the camera moves to the right; everything belongs to the world.
class FrontEndTest : public ::testing::Test {
 protected:
  static FrontEndConfig small() {
    FrontEndConfig config;
    config.max_points = 200;
    return config;
  }
  // `areas`: where refill starts more points; `force`: refill even where run() was told to spare it.
  PointPairs show(const StereoImages& images, bool may_refill = true, std::span<const RefillArea> areas = {},
                  bool force = false) {
    StereoFrame frame;
    frame.seq = static_cast<std::uint64_t>(shown_++);
    frame.left = images.left.view();
    frame.right = images.right.view();
    const BodyPrediction still{kWorldBody, Rigid3::Identity()};
    const PointPairs pairs = front_end_.run(frame, {&still, 1}, may_refill);
    const std::vector<BodyId> bodies(pairs.size(), kWorldBody);
    front_end_.settle(bodies, {&still, 1});
    front_end_.refill(areas, force);
    return pairs;
  }
  // Share of the pairs that lie where the plane's points went, `steps` of it, and have its disparity.
  static double share_right(PointPairs pairs, double steps) {
    const auto right = std::count_if(pairs.begin(), pairs.end(), [&](const PointPair& pair) {
      const Eigen::Vector3d moved = pair.curr.z_px - pair.prev.z_px;
      const double disparity = pair.curr.z_px.x() - pair.curr.z_px.z();
      return std::abs(moved.x() + steps * kFlow_px) < 0.2 && std::abs(moved.y()) < 0.2 &&
             std::abs(disparity - kDisparity_px) < 0.2;
    });
    return static_cast<double>(right) / static_cast<double>(pairs.size());
  }
  [[nodiscard]] long tracks_within(double u, double v, double half_px) const {
    const auto tracks = front_end_.tracks();
    return std::count_if(tracks.begin(), tracks.end(), [&](const Track& track) {
      return std::abs(track.latest.z_px.x() - u) < half_px && std::abs(track.latest.z_px.y() - v) < half_px;
    });
  }

  InlineWorker worker_;
  FrontEnd front_end_{small(), kBoardRig, {worker_, worker_}};
  int shown_ = 0;
};

TEST_F(FrontEndTest, ThePointsOfAPlaneMoveAsItDoesAndKeepTheirTracks) {
  PointPairs pairs;
  std::vector<TrackId> first;
  for (int frame = 0; frame < 8; ++frame) {
    pairs = show(test::plane(frame));
    if (frame == 1) {
      for (const PointPair& pair : pairs) first.push_back(pair.track);
    }
  }
  ASSERT_GT(pairs.size(), 100U);
  EXPECT_GT(share_right(pairs, 1), 0.98);
  const auto kept = std::count_if(pairs.begin(), pairs.end(), [&](const PointPair& pair) {
    return std::find(first.begin(), first.end(), pair.track) != first.end();
  });
  // 15 px of 320 left the view: a twentieth; as many again at its other border have no partner on the right.
  EXPECT_GT(static_cast<double>(kept), 0.75 * static_cast<double>(first.size()));
  for (const PointPair& pair : pairs) {
    EXPECT_LE(pair.past_size, std::min(pair.age - 1, kPastFrames));
    if (pair.past_size > 0) {
      EXPECT_NEAR(pair.past[0].x() - pair.prev.z_px.x(), kFlow_px, 0.5);
    }
  }
}

TEST_F(FrontEndTest, StartsKeepTheirDistanceAndFillTheView) {
  show(test::plane(0));
  const auto tracks = front_end_.tracks();
  ASSERT_GT(tracks.size(), 100U);
  for (std::size_t a = 0; a < tracks.size(); ++a) {
    for (std::size_t b = a + 1; b < tracks.size(); ++b) {
      EXPECT_GE((tracks[a].latest.z_px - tracks[b].latest.z_px).head<2>().norm(), FrontEndConfig{}.min_distance_px);
    }
  }
  for (const double u : {80.0, 240.0}) {
    for (const double v : {60.0, 180.0}) EXPECT_GT(tracks_within(u, v, 60), 10) << u << ", " << v;
  }
}

TEST_F(FrontEndTest, InsideABodysOutlinePointsStandDenser) {
  RefillArea area;
  area.outline = {{{110, 70}, {210, 70}, {210, 170}, {110, 170}}};
  area.outline_size = 4;
  show(test::plane(0));
  const long before = tracks_within(160, 120, 50);
  area.points_inside = static_cast<int>(before);
  show(test::plane(1), false, {&area, 1}, true);
  EXPECT_GT(tracks_within(160, 120, 50), 5 * before / 4);
}

TEST_F(FrontEndTest, RefillIsSparedWhenAskedTo) {
  show(test::plane(0));
  const std::size_t started = front_end_.tracks().size();
  for (int frame = 1; frame < 8; ++frame) {
    show(test::plane(frame), false);
    EXPECT_FALSE(front_end_.counts().refilled) << "frame " << frame;
    EXPECT_LE(front_end_.tracks().size(), started);
  }
}

TEST_F(FrontEndTest, ALeapIsBridgedByDescriptors) {
  for (int frame = 0; frame < 3; ++frame) show(test::plane(frame));
  // 70 px at once, with nothing predicted.
  const PointPairs pairs = show(test::plane(30));
  EXPECT_GT(front_end_.counts().bridged, 50);
  ASSERT_GT(pairs.size(), 50U);
  EXPECT_GT(share_right(pairs, 28), 0.95);
}

TEST_F(FrontEndTest, PairsStateTheNoiseThatWasSet) {
  show(test::plane(0));
  front_end_.set_sigma(0.37);
  const PointPairs pairs = show(test::plane(1));
  ASSERT_GT(pairs.size(), 50U);
  for (const PointPair& pair : pairs) EXPECT_EQ(pair.sigma_px, 0.37);
}

TEST_F(FrontEndTest, DroppedTracksAreGone) {
  show(test::plane(0));
  const PointPairs pairs = show(test::plane(1));
  ASSERT_GT(pairs.size(), 50U);
  const std::vector<TrackId> dropped{pairs[3].track, pairs[10].track};
  front_end_.drop(dropped);
  const PointPairs next = show(test::plane(2));
  ASSERT_GT(next.size(), 50U);
  for (const PointPair& pair : next) {
    EXPECT_EQ(std::count(dropped.begin(), dropped.end(), pair.track), 0);
  }
}

}  // namespace
}  // namespace pelorus
