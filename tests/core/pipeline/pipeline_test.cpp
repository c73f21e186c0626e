#include "core/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "core/geometry/rigid_fit.h"
#include "tests/core/pipeline/board_world.h"
#include "tests/support/held_worker.h"

namespace pelorus {
namespace {

using test::Board;
using test::grey;
using test::HeldWorker;
using test::plane;
using test::plane_with_board;
using test::StereoImages;
const StereoRig& kRig = test::kBoardRig;

FrameResult step(Pipeline& pipeline, int frame, const StereoImages& images, Shed shed = Shed::nothing) {
  return pipeline.step(
      {static_cast<std::uint64_t>(frame), Timestamp{frame * 100'000'000LL}, images.left.view(), images.right.view()},
      shed);
}

bool finite(const FrameResult& result) {
  return result.T_world_cam.matrix().allFinite() && result.cov_T_world_cam.allFinite() &&
         result.T_curr_prev.matrix().allFinite() && result.cov_T_curr_prev.allFinite();
}

void expect_equal(const FrameResult& a, const FrameResult& b) {
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.pose_valid, b.pose_valid);
  EXPECT_EQ(a.T_world_cam.matrix(), b.T_world_cam.matrix());
  EXPECT_EQ(a.cov_T_world_cam, b.cov_T_world_cam);
  EXPECT_EQ(a.T_curr_prev.matrix(), b.T_curr_prev.matrix());
  EXPECT_EQ(a.cov_T_curr_prev, b.cov_T_curr_prev);
  EXPECT_EQ(a.world_confidence, b.world_confidence);
  ASSERT_EQ(a.objects_size, b.objects_size);
  for (std::size_t i = 0; i < a.objects_view().size(); ++i) {
    const ObjectState& left = a.objects[i];
    const ObjectState& right = b.objects[i];
    EXPECT_EQ(left.id, right.id);
    EXPECT_EQ(left.phase, right.phase);
    EXPECT_EQ(left.points, right.points);
    EXPECT_EQ(left.T_world_obj.matrix(), right.T_world_obj.matrix());
    EXPECT_EQ(left.cov_T_world_obj, right.cov_T_world_obj);
    EXPECT_EQ(left.M_world.matrix(), right.M_world.matrix());
  }
  EXPECT_EQ(a.report.points_tracked, b.report.points_tracked);
  EXPECT_EQ(a.report.points_started, b.report.points_started);
  EXPECT_EQ(a.report.points_static, b.report.points_static);
  EXPECT_EQ(a.report.points_outlier, b.report.points_outlier);
  EXPECT_EQ(a.report.sigma_px, b.report.sigma_px);
}

// Both see the board pass; they must agree in every frame, and find it.
void expect_equal_runs(Pipeline& a, Pipeline& b, int frames, Shed shed_a = Shed::nothing, Shed shed_b = Shed::nothing) {
  FrameResult result;
  for (int frame = 0; frame < frames; ++frame) {
    const StereoImages images = plane_with_board(frame, {});
    result = step(a, frame, images, shed_a);
    expect_equal(result, step(b, frame, images, shed_b));
  }
  EXPECT_EQ(result.objects_size, 1);
}

TEST(Pipeline, FollowsTheCameraPastAPlaneAtRest) {
  Pipeline pipeline({}, kRig);
  FrameResult result;
  for (int frame = 0; frame < 5; ++frame) {
    result = step(pipeline, frame, plane(frame));
    EXPECT_TRUE(result.pose_valid);
    EXPECT_EQ(result.state == VisionState::init, frame == 0);
    const StageOutcome filters = result.report[Stage::static_filters].outcome;
    EXPECT_EQ(filters, frame == 0 ? StageOutcome::not_run : StageOutcome::ok);
    const StageOutcome refill = result.report[Stage::refill].outcome;
    EXPECT_EQ(refill, result.report.refilled ? StageOutcome::ok : StageOutcome::not_run);
    if (frame == 0) {
      EXPECT_EQ(refill, StageOutcome::ok);
    }
  }
  // 4 steps of 30 mm; 1 % of it, and depth uncertain by its deviation.
  EXPECT_LT((result.T_world_cam.translation() - Eigen::Vector3d(0.12, 0, 0)).norm(), 0.01);
  EXPECT_LT(rotation_angle_rad(result.T_world_cam.linear()), 0.005);
  EXPECT_EQ(result.objects_size, 0);
  EXPECT_EQ(result.reset_counter, 0);
  EXPECT_GT(result.report.points_static, 50);
}

TEST(Pipeline, AMovingBoardIsOneObjectWithItsMotion) {
  Pipeline pipeline({}, kRig);
  FrameResult result;
  for (int frame = 0; frame < 10; ++frame) result = step(pipeline, frame, plane_with_board(frame, {}));
  ASSERT_EQ(result.objects_size, 1);
  const ObjectState& object = result.objects.front();
  EXPECT_EQ(object.phase, ObjectPhase::confirmed);
  EXPECT_EQ(object.id, BodyId{1});
  const Eigen::Vector3d p_world = object.centroid_world;
  EXPECT_LT((object.M_world * p_world - p_world - Eigen::Vector3d(0.008, 0, 0)).norm(), 0.001);
  EXPECT_NEAR(p_world.z(), 2.0, 0.02);
  EXPECT_LT((result.T_world_cam.translation() - Eigen::Vector3d(0.27, 0, 0)).norm(), 0.01);
}

TEST(Pipeline, ABodyHasMorePointsWhereRefillKnowsItsOutline) {
  int points[2] = {};
  for (const bool refill : {false, true}) {
    PipelineConfig config;
    config.front_end.max_points = 300;
    config.steps.object_refill = refill;
    Pipeline pipeline(config, kRig);
    FrameResult result;
    for (int frame = 0; frame < 14; ++frame) result = step(pipeline, frame, plane_with_board(frame, {}));
    ASSERT_EQ(result.objects_size, 1);
    points[refill] = result.objects[0].points;
  }
  EXPECT_GT(points[1], 5 * points[0] / 4);
}

TEST(Pipeline, AKnownBodyThatSetsOffSlowlyDoesNotDragTheCameraAlong) {
  Pipeline pipeline({}, kRig);
  const Board moves_rests_and_sets_off{14, 0.15};
  FrameResult before;
  for (int frame = 0; frame < 30; ++frame) {
    // Known from its first eight frames; then it rests.
    const int shown = std::min(frame, 8);
    StereoImages images = frame <= 8 ? plane_with_board(frame, {}) : StereoImages{};
    if (frame > 8) {
      Board board = moves_rests_and_sets_off;
      board.offset_m = Board{}.place_m(shown);
      images = plane_with_board(frame, board);
    }
    const FrameResult result = step(pipeline, frame, images);
    ASSERT_TRUE(result.pose_valid);
    const auto bodies = result.objects_view();
    if (frame == 8) {  // else there is no known body to set off
      ASSERT_EQ(bodies.size(), 1U);
      ASSERT_EQ(bodies[0].phase, ObjectPhase::confirmed);
    }
    if (frame > 0) {
      const Rigid3 step_cam = before.T_world_cam.inverse() * result.T_world_cam;
      EXPECT_LT((step_cam.translation() - Eigen::Vector3d(0.03, 0, 0)).norm(), 0.0008) << "frame " << frame;
    }
    before = result;
  }
}

TEST(Pipeline, AGreyFrameIsSaidToBeLostAndTheNextGoodOnesGoOn) {
  Pipeline pipeline({}, kRig);
  for (int frame = 0; frame < 3; ++frame) (void)step(pipeline, frame, plane(frame));
  for (int frame = 3; frame < 5; ++frame) {
    const FrameResult lost = step(pipeline, frame, grey());
    EXPECT_EQ(lost.state, VisionState::lost);
    EXPECT_FALSE(lost.pose_valid);
    EXPECT_TRUE(finite(lost));
    EXPECT_EQ(lost.reset_counter, 1);  // one loss, however long
  }
  FrameResult result;
  for (int frame = 5; frame < 8; ++frame) {
    result = step(pipeline, frame, plane(frame));
    EXPECT_EQ(result.pose_valid, frame > 5);  // the first good frame only starts points
    EXPECT_TRUE(finite(result));
    EXPECT_EQ(result.reset_counter, 1);
  }
  // It went on from where it was lost: two steps of 30 mm before the loss and two after it are what it knows.
  EXPECT_LT((result.T_world_cam.translation() - Eigen::Vector3d(0.12, 0, 0)).norm(), 0.01);
  EXPECT_LT((result.T_curr_prev.translation() - Eigen::Vector3d(-0.03, 0, 0)).norm(), 0.001);
}

TEST(Pipeline, ABodySeenAgainAfterALossHasTheMotionOfOneStep) {
  Pipeline pipeline({}, kRig);
  FrameResult result;
  for (int frame = 0; frame < 10; ++frame) result = step(pipeline, frame, plane_with_board(frame, {}));
  ASSERT_EQ(result.objects_size, 1);
  for (int frame = 10; frame < 13; ++frame) {
    const FrameResult lost = step(pipeline, frame, grey());
    ASSERT_EQ(lost.state, VisionState::lost);
    EXPECT_EQ(lost.objects_size, 0);  // where bodies are in the world is not known
    EXPECT_TRUE(lost.T_curr_prev.matrix().isIdentity());
  }
  int seen = 0;
  for (int frame = 13; frame < 24; ++frame) {
    result = step(pipeline, frame, plane_with_board(frame, {}));
    // No point outlives a grey frame: the first good one only starts new ones.
    ASSERT_EQ(result.pose_valid, frame > 13) << "frame " << frame;
    for (const ObjectState& object : result.objects_view()) {
      if (object.phase != ObjectPhase::confirmed) continue;
      EXPECT_EQ(object.id, BodyId{1}) << "frame " << frame;
      EXPECT_TRUE(object.motion_measured) << "frame " << frame;
      const Eigen::Vector3d p_world = object.centroid_world;
      EXPECT_LT((object.M_world * p_world - p_world - Eigen::Vector3d(0.008, 0, 0)).norm(), 0.001) << "frame " << frame;
      ++seen;
    }
  }
  EXPECT_EQ(seen, 10);
}

TEST(Pipeline, AWorldThatAnotherGroupMightBeIsDegradedForThatReason) {
  PipelineConfig config;
  config.ego_motion.degraded_confidence = 2.0;  // more than anything can have
  Pipeline doubting(config, kRig);
  Pipeline pipeline({}, kRig);
  for (int frame = 0; frame < 3; ++frame) {
    const FrameResult result = step(doubting, frame, plane(frame));
    EXPECT_EQ(result.state == VisionState::degraded, frame > 0);
    EXPECT_EQ(result.world_ambiguous, frame > 0);
    EXPECT_FALSE(step(pipeline, frame, plane(frame)).world_ambiguous);
  }
}

TEST(Pipeline, AWorldOfFewPointsIsDegradedButNotAmbiguous) {
  PipelineConfig config;
  config.ego_motion.degraded_static_points = config.front_end.max_points + 1;
  Pipeline pipeline(config, kRig);
  for (int frame = 0; frame < 3; ++frame) {
    const FrameResult result = step(pipeline, frame, plane(frame));
    EXPECT_EQ(result.state == VisionState::degraded, frame > 0);
    EXPECT_FALSE(result.world_ambiguous);
  }
}

// The state at the fourth frame of the board's passing when fewer points than `least` carry the motion too few.
FrameResult fourth_frame(int least) {
  PipelineConfig config;
  config.ego_motion.degraded_static_points = least;
  Pipeline pipeline(config, kRig);
  FrameResult result;
  for (int frame = 0; frame < 4; ++frame) result = step(pipeline, frame, plane_with_board(frame, {}));
  return result;
}

// Points of the plane around the board stand among moving ones: suspect, but they fit.
TEST(Pipeline, SuspectsThatFitCarryTheMotionAgain) {
  const int fitting = fourth_frame(0).report.points_static;
  ASSERT_GT(fitting, 50);
  EXPECT_EQ(fourth_frame(fitting).state, VisionState::tracking);
  EXPECT_EQ(fourth_frame(fitting + 1).state, VisionState::degraded) << "the limit is that of these points";
}

using PointsBefore = std::map<std::int64_t, Eigen::Vector3d>;

// The alignment of the body's points of two frames.
std::optional<Rigid3> aligned(BodyId body, const PointsBefore& before, std::span<const PointView> now) {
  std::vector<PointMatch> clouds;
  for (const PointView& point : now) {
    const auto known = before.find(point.track.value);
    if (point.body == body && known != before.end()) clouds.push_back({known->second, point.curr.p_cam, 1.0});
  }
  return fit_rigid(clouds);
}

// How far the board's motion before the camera is from the alignment of its points, in the mean of eight frames.
double distance_from_alignment(bool bundle_adjustment) {
  PipelineConfig config;
  config.steps.bundle_adjustment = bundle_adjustment;
  config.steps.object_window = false;  // has a motion of its own
  Pipeline pipeline(config, kRig);
  PointsBefore before;
  Rigid3 T_world_prev = Rigid3::Identity();
  double sum = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const FrameResult result = step(pipeline, frame, plane_with_board(frame, {}));
    if (frame >= 4) {  // before, its points still change
      EXPECT_EQ(result.objects_size, 1);
      const ObjectState& object = result.objects.front();
      const Rigid3 H_curr_prev = result.T_world_cam.inverse() * object.M_world * T_world_prev;
      sum += se3_log(H_curr_prev * aligned(object.id, before, pipeline.points()).value().inverse()).norm();
    }
    before.clear();
    for (const PointView& point : pipeline.points()) before[point.track.value] = point.curr.p_cam;
    T_world_prev = result.T_world_cam;
  }
  return sum / 8;
}

TEST(Pipeline, WithoutBundleAdjustmentTheMotionOfBodiesIsAnAlignmentToo) {
  EXPECT_LT(distance_from_alignment(false), 0.25 * distance_from_alignment(true));
}

TEST(Pipeline, GreyFromTheStartIsNeverAGoodMotion) {
  Pipeline pipeline({}, kRig);
  (void)step(pipeline, 0, grey());
  for (int frame = 1; frame < 4; ++frame) {
    const FrameResult result = step(pipeline, frame, grey());
    EXPECT_EQ(result.state, VisionState::lost);
    EXPECT_FALSE(result.pose_valid);
    EXPECT_TRUE(finite(result));
  }
}

TEST(Pipeline, TwoInstancesGiveIdenticalResults) {
  Pipeline first({}, kRig);
  Pipeline second({}, kRig);
  expect_equal_runs(first, second, 8);
}

// So that a recording that begins anywhere, or a replay of what a live run saw, has the same draws.
TEST(Pipeline, NumbersOfFramesThatBeginElsewhereChangeNothing) {
  Pipeline from_zero({}, kRig);
  Pipeline from_seven({}, kRig);
  FrameResult result;
  for (int frame = 0; frame < 8; ++frame) {
    const StereoImages images = plane_with_board(frame, {});
    const Timestamp time{frame * 100'000'000LL};
    result = from_zero.step({static_cast<std::uint64_t>(frame), time, images.left.view(), images.right.view()});
    expect_equal(result, from_seven.step(
                             {static_cast<std::uint64_t>(frame + 7), time, images.left.view(), images.right.view()}));
  }
  EXPECT_EQ(result.objects_size, 1);
}

TEST(Pipeline, FramesThatWereMissedAreCountedAndBridged) {
  Pipeline pipeline({}, kRig);
  for (int frame = 0; frame < 3; ++frame) (void)step(pipeline, frame, plane(frame));
  const FrameResult result = step(pipeline, 5, plane(5));
  EXPECT_EQ(result.report.frames_missed, 2);
  EXPECT_TRUE(result.pose_valid);
  EXPECT_LT((result.T_world_cam.translation() - Eigen::Vector3d(0.15, 0, 0)).norm(), 0.01);
}

TEST(Pipeline, WorkersThatStartAsLateAsTheyMayChangeNothing) {
  HeldWorker tracking, surf, refine;
  Pipeline late({}, kRig, {&tracking, &surf, &refine, true});
  Pipeline at_once({}, kRig);
  expect_equal_runs(at_once, late, 8);
}

PipelineConfig without_static_window() {
  PipelineConfig config;
  config.steps.static_window = false;
  return config;
}

TEST(Pipeline, AWindowThatIsNotReadyIsNotWaitedForAndItsAnswerIsTakenWhenItIs) {
  HeldWorker refine;
  Pipeline live({}, kRig, {nullptr, nullptr, &refine, false});
  Pipeline never(without_static_window(), kRig);
  for (int frame = 0; frame < 6; ++frame) {
    const StereoImages images = plane_with_board(frame, {});
    expect_equal(step(live, frame, images), step(never, frame, images));
    EXPECT_EQ(refine.done(), frame == 0);
  }
  refine.wait();
  const StereoImages images = plane_with_board(6, {});
  const FrameResult drawn = step(live, 6, images);
  EXPECT_EQ(drawn.report[Stage::static_window].outcome, StageOutcome::ok);
  const FrameResult alone = step(never, 6, images);
  EXPECT_NE(drawn.T_world_cam.matrix(), alone.T_world_cam.matrix());
  EXPECT_LT((drawn.T_world_cam.translation() - Eigen::Vector3d(0.18, 0, 0)).norm(), 0.01);
  EXPECT_FALSE(refine.done()) << "the frame after it is given";
}

TEST(Pipeline, WhatTheWindowWasGivenBeforeALossIsOfNoUseAfterIt) {
  HeldWorker refine;
  Pipeline live({}, kRig, {nullptr, nullptr, &refine, false});
  Pipeline never(without_static_window(), kRig);
  for (int frame = 0; frame < 7; ++frame) {
    if (frame == 4) refine.wait();  // ready with a frame that track was lost after
    const StereoImages images = frame == 3 || frame == 4 ? grey() : plane(frame);
    expect_equal(step(live, frame, images), step(never, frame, images));
  }
  refine.wait();
  const FrameResult after = step(live, 7, plane(7));
  EXPECT_EQ(after.report[Stage::static_window].outcome, StageOutcome::ok);
  EXPECT_LT((after.T_curr_prev.translation() - Eigen::Vector3d(-0.03, 0, 0)).norm(), 0.001);
  EXPECT_FALSE(refine.done());  // and the pipeline ends while its last piece is held
}

TEST(Pipeline, ShedWorkIsLeftOutAndNothingElse) {
  // Eight frames of everything, then no new points while fewer and fewer are left.
  Pipeline pipeline({}, kRig);
  FrameResult result;
  for (int frame = 0; frame < 8; ++frame) result = step(pipeline, frame, plane_with_board(frame, {}));
  const int tracked = result.report.points_tracked;
  for (int frame = 8; frame < 16; ++frame) {
    result = step(pipeline, frame, plane_with_board(frame, {}), Shed::refill);
    EXPECT_EQ(result.report.points_started, 0) << frame;
    EXPECT_EQ(result.report.shed, Shed::refill);
    EXPECT_EQ(result.report[Stage::refill].outcome, StageOutcome::skipped);
    EXPECT_EQ(result.state, VisionState::tracking) << frame;
    EXPECT_EQ(result.objects_size, 1) << frame;
  }
  EXPECT_LT(result.report.points_tracked, tracked);
  result = step(pipeline, 16, plane_with_board(16, {}));
  EXPECT_GT(result.report.points_started, 0) << "made up for as soon as there is time";
  EXPECT_LT((result.T_world_cam.translation() - Eigen::Vector3d(0.48, 0, 0)).norm(), 0.01);
}

TEST(Pipeline, ShedObjectWindowsAreAsIfSwitchedOff) {
  PipelineConfig without;
  without.steps.object_window = false;
  Pipeline shedding({}, kRig);
  Pipeline switched_off(without, kRig);
  expect_equal_runs(shedding, switched_off, 12, Shed::object_window, Shed::refill);
}

}  // namespace
}  // namespace pelorus
