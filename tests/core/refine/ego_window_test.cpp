#include "core/refine/ego_window.h"

#include <gtest/gtest.h>

#include "tests/support/held_worker.h"
#include "tests/support/point_world.h"

namespace pelorus {
namespace {

using test::HeldWorker;
using test::kRig;
using test::twist;

StageOutcome outcome = StageOutcome::not_run;  // of what was collected last

// A camera that passes a cloud of points at rest; one of them can be made to creep.
struct Passage {
  std::vector<Eigen::Vector3d> p_world;
  int creeping = -1;
  Vector6d step = twist(0.02, 0.005, 0.01, 0.002, -0.004, 0.001);

  Passage() {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> side(-0.8, 0.8);
    for (int i = 0; i < 60; ++i) p_world.emplace_back(side(random), side(random), 2.5 + side(random));
  }
  [[nodiscard]] Rigid3 T_world_cam(int frame) const { return se3_exp(frame * step); }
  [[nodiscard]] std::vector<WindowObservation> observe(int frame) const {
    std::vector<WindowObservation> seen;
    for (std::size_t i = 0; i < p_world.size(); ++i) {
      Eigen::Vector3d p = p_world[i];
      if (static_cast<int>(i) == creeping) p.x() += 0.01 * frame;
      seen.push_back({TrackId{i + 1}, kRig.project(T_world_cam(frame).inverse() * p), 0.1});
    }
    return seen;
  }
  // Motion from frame a to b, a little wrong as that of two frames is.
  [[nodiscard]] Rigid3 H(int a, int b) const {
    return se3_exp(twist(0.002, -0.001, 0.001, 0.0004, 0, 0)) * T_world_cam(b).inverse() * T_world_cam(a);
  }
  void give(EgoWindow& window, int from, int frame) const {
    const auto before = window.is_new() ? observe(from) : std::vector<WindowObservation>{};
    window.give(Timestamp{frame * 100'000'000LL}, 0.1, H(from, frame), T_world_cam(from), before, observe(frame));
  }
};

TEST(EgoWindow, ItsAnswerComesWithALaterFrameAndIsTheTruePose) {
  const Passage passage;
  InlineWorker worker;
  EgoWindow window({}, kRig, 100, 9.0, worker);
  EXPECT_FALSE(window.collect(true, outcome));
  for (int frame = 1; frame < 12; ++frame) {
    passage.give(window, frame - 1, frame);
    EXPECT_FALSE(window.idle());
    const auto answer = window.collect(true, outcome);
    ASSERT_TRUE(answer) << frame;
    EXPECT_LT(se3_log(answer->T_cam_world * passage.T_world_cam(frame)).norm(), 2e-4) << frame;
    EXPECT_FALSE(window.collect(true, outcome)) << "an answer is given once";
  }
}

TEST(EgoWindow, IsNotWaitedForAndTheFramesItMissedAreBridged) {
  const Passage passage;
  HeldWorker worker;
  EgoWindow window({}, kRig, 100, 9.0, worker);
  for (int frame = 1; frame < 6; ++frame) {
    passage.give(window, frame - 1, frame);
    EXPECT_FALSE(window.collect(false, outcome)) << "still at work";
    EXPECT_FALSE(window.idle());
    worker.wait();
    ASSERT_TRUE(window.collect(false, outcome));
  }
  passage.give(window, 5, 8);  // two frames passed while it was at work
  const auto answer = window.collect(true, outcome);
  ASSERT_TRUE(answer);
  EXPECT_LT(se3_log(answer->T_cam_world * passage.T_world_cam(8)).norm(), 2e-4);
}

TEST(EgoWindow, WhatWasGivenBeforeALossIsNotCollectedAfterIt) {
  const Passage passage;
  HeldWorker worker;
  EgoWindow window({}, kRig, 100, 9.0, worker);
  for (int frame = 1; frame < 4; ++frame) {
    passage.give(window, frame - 1, frame);
    ASSERT_TRUE(window.collect(true, outcome));
  }
  passage.give(window, 3, 4);
  window.forget();
  EXPECT_FALSE(window.collect(false, outcome));
  EXPECT_FALSE(window.idle()) << "the worker still has the old frame";
  worker.wait();
  EXPECT_FALSE(window.collect(false, outcome)) << "of the time before the loss";
  EXPECT_TRUE(window.idle());
  EXPECT_TRUE(window.is_new());
  passage.give(window, 30, 31);
  const auto answer = window.collect(true, outcome);
  ASSERT_TRUE(answer);
  EXPECT_LT(se3_log(answer->T_cam_world * passage.T_world_cam(31)).norm(), 2e-4);
}

TEST(EgoWindow, OneThatCannotBeSolvedSaysSoAndStartsAnew) {
  const Passage passage;
  InlineWorker worker;
  EgoWindow window({}, kRig, 100, 9.0, worker);
  passage.give(window, 0, 1);
  ASSERT_TRUE(window.collect(true, outcome));
  EXPECT_EQ(outcome, StageOutcome::ok);
  for (int failures = 0; !window.is_new(); ++failures) {
    ASSERT_LT(failures, 20);
    window.give(Timestamp{failures * 100'000'000LL}, 0.1, Rigid3::Identity(), Rigid3::Identity(), {}, {});
    EXPECT_FALSE(window.collect(true, outcome));
    EXPECT_EQ(outcome, StageOutcome::too_few_points);
  }
  passage.give(window, 40, 41);
  const auto answer = window.collect(true, outcome);
  ASSERT_TRUE(answer);
  EXPECT_LT(se3_log(answer->T_cam_world * passage.T_world_cam(41)).norm(), 2e-4);
}

TEST(EgoWindow, APointThatCreepsIsNamed) {
  Passage passage;
  passage.creeping = 7;
  InlineWorker worker;
  EgoWindow window({}, kRig, 100, 9.0, worker);
  bool named = false;
  for (int frame = 1; frame < 8; ++frame) {
    passage.give(window, frame - 1, frame);
    const auto answer = window.collect(true, outcome);
    ASSERT_TRUE(answer);
    for (const TrackId track : answer->misfits) {
      EXPECT_EQ(track, TrackId{8});
      named = true;
    }
  }
  EXPECT_TRUE(named);
}

}  // namespace
}  // namespace pelorus
