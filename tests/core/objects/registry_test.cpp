#include "core/objects/registry.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/motion/repartition.h"
#include "tests/core/objects/synthetic_descriptor.h"
#include "tests/support/point_world.h"

namespace pelorus {
namespace {

using test::descriptor_of;
using test::kRig;
using test::PointWorld;
using test::twist;
using test::WorldView;

constexpr double kSigma_px = 0.1;

// The registry's passage through consecutive steps of a world of points, with the true camera poses.
class Passage {
 public:
  explicit Passage(const PointWorld& world, bool acceleration_prior = true)
      : world_(world),
        registry_({}, {}, {}, {}, {}, {.recent_frames = 6, .key_frames = 4, .acceleration_prior = acceleration_prior},
                  {}, 1000) {}

  // `called_moving`: a body whose points are said to move, whatever they do.
  void step(int frame, bool bodies_seen = true, int called_moving = -1) {
    WorldView view = world_.observe(frame + 1, kSigma_px, kSigma_px);
    if (!bodies_seen) keep_floor(view);
    if (hidden_body > 0) hide(view, hidden_body);
    for (PointPair& pair : view.pairs) pair.track.value += new_tracks_;
    restore_bodies(view);
    const std::size_t count = view.pairs.size();
    std::vector<PointRole> roles(count);
    std::vector<double> chi2(count);
    repartition(kRig, view.pairs, static_motions(view), {}, roles, chi2);
    std::vector<Track> tracks(count);
    std::vector<const Track*> track_of_pair;
    for (std::size_t i = 0; i < count; ++i) {
      if (view.body_of[i] == called_moving) roles[i] = PointRole::moving;
      tracks[i].descriptor = descriptor_of(view.pairs[i].track.value % 1000);
      tracks[i].has_descriptor = true;
      track_of_pair.push_back(&tracks[i]);
    }
    WorldStep step;
    step.time = Timestamp{frame * 100'000'000LL};
    step.T_world_prev = view.T_world_cam[static_cast<std::size_t>(frame) - 1];
    step.T_world_curr = view.T_world_cam.back();
    step.seed = static_cast<std::uint64_t>(frame);
    std::vector<BodyId> owner(count, kNoBody);
    registry_.predict(step.T_world_prev, step.T_world_curr, step.dt_s);
    registry_.claim(kRig, view.pairs, roles, chi2, step, {}, owner);
    std::vector<PointIndex> open;
    for (std::size_t i = 0; i < count; ++i) {
      if (roles[i] == PointRole::moving && owner[i] == kNoBody) open.push_back(static_cast<PointIndex>(i));
    }
    Partition groups;
    if (!open.empty() && view.body_of[static_cast<std::size_t>(open.back())] > 0) {
      for (int body = 1; body < static_cast<int>(view.M_world.size()); ++body) add_group(view, open, body, groups);
    }
    registry_.adopt(kRig, view.pairs, roles, groups, track_of_pair, step, steps, owner);
    registry_.settle(kRig, view.pairs, roles, chi2, track_of_pair, step, steps, owner);
    for (std::size_t i = 0; i < count; ++i) {
      if (owner[i] == kNoBody && roles[i] == PointRole::fixed) owner[i] = kWorldBody;
      body_of_track_.resize(std::max(body_of_track_.size(), std::size_t{view.pairs[i].track.value} + 1), kNoBody);
      body_of_track_[view.pairs[i].track.value] = owner[i];
    }
    view_ = std::move(view);
  }
  void forget_tracks() { body_of_track_.clear(); }
  int hidden_body = -1;  // something stands before it
  RegistrySteps steps;
  // The front end finds the same spots anew, or others: descriptors follow the track's number modulo 1000.
  void start_new_tracks() { start_tracks_after(1000); }
  void show_another_side() { start_tracks_after(1500); }
  void lose() {
    registry_.lose();
    forget_tracks();
  }
  [[nodiscard]] const Registry& registry() const { return registry_; }
  [[nodiscard]] std::span<const MovingBody> bodies() const { return registry_.bodies(); }
  [[nodiscard]] const WorldView& view() const { return view_; }

 private:
  void start_tracks_after(std::uint64_t numbers) {
    forget_tracks();
    new_tracks_ += numbers;
  }
  static void hide(WorldView& view, int body) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < view.pairs.size(); ++i) {
      if (view.body_of[i] == body) continue;
      view.pairs[kept] = view.pairs[i];
      view.body_of[kept++] = view.body_of[i];
    }
    view.pairs.resize(kept);
    view.body_of.resize(kept);
  }
  static void keep_floor(WorldView& view) {
    std::erase_if(view.pairs, [&](const PointPair& p) {
      return view.body_of[static_cast<std::size_t>(&p - view.pairs.data())] != 0;
    });
    std::erase_if(view.body_of, [](int body) { return body != 0; });
  }
  void restore_bodies(WorldView& view) const {
    for (PointPair& pair : view.pairs) {
      pair.previous_body = pair.track.value < body_of_track_.size() ? body_of_track_[pair.track.value] : kNoBody;
    }
  }
  static StaticMotions static_motions(const WorldView& view) {
    StaticMotions motions;
    const std::size_t last = view.T_world_cam.size() - 1;
    for (std::size_t j = 0; j <= kPastFrames && j < last; ++j) {
      motions.T_curr_past[j] = view.T_world_cam[last].inverse() * view.T_world_cam[last - 1 - j];
      ++motions.size;
    }
    return motions;
  }
  static void add_group(const WorldView& view, const std::vector<PointIndex>& open, int body, Partition& groups) {
    Group group;
    group.H_curr_prev = view.H_curr_prev(body);
    for (const PointIndex i : open) {
      if (view.body_of[static_cast<std::size_t>(i)] == body) group.members.push_back(i);
    }
    if (!group.members.empty()) groups.groups.push_back(group);
  }

  PointWorld world_;
  Registry registry_;
  std::vector<BodyId> body_of_track_;
  std::uint64_t new_tracks_ = 0;
  WorldView view_;
};

PointWorld slow_camera(int floor_points) {
  PointWorld world(floor_points);
  world.twist_cam = twist(0.004, 0.002, 0.003, 0.0005, -0.001, 0.0005);
  return world;
}

TEST(Registry, AMovingBodyIsBornConfirmedAndItsMotionIsTrue) {
  PointWorld world = slow_camera(100);
  world.add_body(40, {0, 0, 2.0}, 0.25, twist(0.02, 0.005, 0.01, 0, 0.02, 0));
  Passage passage(world);
  for (int frame = 1; frame <= 10; ++frame) passage.step(frame);
  ASSERT_EQ(passage.bodies().size(), 1U);
  const MovingBody& body = passage.bodies()[0];
  EXPECT_EQ(body.phase, ObjectPhase::confirmed);
  EXPECT_EQ(body.id, BodyId{1});
  EXPECT_GE(body.members.size(), 38U);
  const Eigen::Vector3d center = body.T_world_obj * body.centroid_obj;
  const Rigid3& M_true = passage.view().M_world[1];
  // Depth of the centroid in one step: z^2 sqrt(2) sigma sqrt(2) / (f b sqrt(40)) = 1.3 mm.
  EXPECT_LT((body.M_world * center - M_true * center).norm(), 4 * 0.0013);
  EXPECT_LT(rotation_angle_rad(body.M_world.linear() * M_true.linear().transpose()), 0.01);
}

TEST(Registry, AGroupThatIsAtRestIsNeverConfirmed) {
  PointWorld world = slow_camera(100);
  world.add_body(40, {0, 0, 2.0}, 0.25, twist(0, 0, 0, 0, 0, 0));
  Passage passage(world);
  for (int frame = 1; frame <= 8; ++frame) {
    passage.step(frame, true, 1);
    ASSERT_EQ(passage.bodies().size(), 1U);
    EXPECT_EQ(passage.bodies()[0].phase, ObjectPhase::tentative);
  }
}

TEST(Registry, ABodyThatComesBackKeepsItsIdAndItsFrame) {
  PointWorld world = slow_camera(100);
  world.add_body(40, {-0.1, 0, 2.0}, 0.25, twist(0.015, 0, 0.005, 0, 0.01, 0));
  Passage passage(world);
  for (int frame = 1; frame <= 8; ++frame) passage.step(frame);
  ASSERT_EQ(passage.bodies().size(), 1U);
  const Rigid3 T_before = passage.bodies()[0].T_world_obj;
  const double cov_before = passage.bodies()[0].cov_T_world_obj.trace();
  for (int frame = 9; frame <= 13; ++frame) passage.step(frame, false);
  ASSERT_EQ(passage.bodies().size(), 1U);
  EXPECT_EQ(passage.bodies()[0].phase, ObjectPhase::coasting);
  EXPECT_FALSE(passage.bodies()[0].measured);
  EXPECT_GT(passage.bodies()[0].cov_T_world_obj.trace(), cov_before);
  passage.forget_tracks();
  for (int frame = 14; frame <= 16; ++frame) passage.step(frame);
  ASSERT_EQ(passage.bodies().size(), 1U);
  const MovingBody& body = passage.bodies()[0];
  EXPECT_EQ(body.id, BodyId{1});
  EXPECT_EQ(body.phase, ObjectPhase::confirmed);
  Rigid3 T_true = T_before;
  for (int frame = 9; frame <= 16; ++frame) T_true = passage.view().M_world[1] * T_true;
  EXPECT_LT((body.T_world_obj.translation() - T_true.translation()).norm(), 0.01);
  EXPECT_LT(rotation_angle_rad(body.T_world_obj.linear() * T_true.linear().transpose()), 0.03);
}

// How well a body's frame is known: mean deviation of a coordinate of its origin, of an axis.
double sigma_m(const MovingBody& body) {
  const Matrix6d cov = transported(body.T_world_obj.inverse(), body.cov_T_world_obj);
  return std::sqrt(cov.topLeftCorner<3, 3>().trace() / 3);
}
bool is_covariance(const Matrix6d& cov) {
  return cov.isApprox(cov.transpose(), 1e-6) && Eigen::SelfAdjointEigenSolver<Matrix6d>(cov).eigenvalues()[0] >= 0;
}

// A body that is met five steps behind where it is, on its way since frame 15: not seen for six frames and 0.5 s more.
struct Return {
  Passage passage;
  Rigid3 T_true;

  explicit Return(const RegistrySteps& steps = {}) : passage(world(), false) {
    passage.steps = steps;
    for (int frame = 1; frame <= 15; ++frame) passage.step(frame);
    T_true = passage.bodies()[0].T_world_obj;
    for (int frame = 16; frame <= 21; ++frame) passage.step(frame, false);
    for (int k = 16; k <= 26; ++k) T_true = passage.view().M_world[1] * T_true;
  }
  static PointWorld world() {
    PointWorld world = slow_camera(100);
    world.add_body(40, {-0.1, 0, 2.0}, 0.25, twist(0.015, 0, 0.005, 0, 0.03, 0));
    return world;
  }
  // The body after the frame, and how far its frame is off.
  const MovingBody& step(int frame, bool seen = true) {
    passage.step(frame, seen);
    T_true = passage.view().M_world[1] * T_true;
    return passage.bodies()[0];
  }
  [[nodiscard]] Rigid3 off() const { return T_true.inverse() * passage.bodies()[0].T_world_obj; }
};

TEST(Registry, ABodyMetAsExpectedFindsTheFrameOfItsBirthAgainWithoutAJumpInItsMotion) {
  for (const bool window : {true, false}) {
    Return back({.object_window = window, .birth_frame = false});
    back.passage.start_new_tracks();
    ASSERT_EQ(back.step(27).id, BodyId{1});
    EXPECT_GT(rotation_angle_rad(back.off().linear()), 0.1);  // five steps of 0.03
    back.passage.steps.birth_frame = true;
    for (int frame = 28; frame <= 32; ++frame) {
      const MovingBody& body = back.step(frame);
      ASSERT_EQ(back.passage.bodies().size(), 1U);
      EXPECT_EQ(body.id, BodyId{1});
      ASSERT_TRUE(body.measured);
      const Eigen::Vector3d center = body.T_world_obj * body.centroid_obj;
      EXPECT_LT((body.M_world * center - back.passage.view().M_world[1] * center).norm(), 0.006) << "frame " << frame;
      for (const PointIndex i : body.members) {
        const PointPair& pair = back.passage.view().pairs[static_cast<std::size_t>(i)];
        const auto point = std::find_if(body.model.begin(), body.model.end(),
                                        [&](const ModelPoint& known) { return known.track == pair.track; });
        ASSERT_NE(point, body.model.end());
        EXPECT_LT((body.T_cam_obj * point->p_obj - pair.curr.p_cam).norm(), 0.03) << "frame " << frame;
      }
      EXPECT_TRUE(is_covariance(body.cov_T_world_obj)) << "frame " << frame;
      EXPECT_LT(back.off().translation().norm(), 6 * sigma_m(body)) << "frame " << frame;
      EXPECT_LT(back.off().translation().norm(), 0.005 + (window ? 0 : 0.01));
      EXPECT_LT(rotation_angle_rad(back.off().linear()), 0.01 + (window ? 0 : 0.02));
      EXPECT_LT(sigma_m(body), 0.01);
      EXPECT_LT(body.extent_m.maxCoeff(), 0.55);
    }
  }
}

TEST(Registry, WithoutRecoveryTheGuessStaysAndSaysSo) {
  Return back({.birth_frame = false});
  back.passage.start_new_tracks();
  for (int frame = 27; frame <= 32; ++frame) {
    const MovingBody& body = back.step(frame);
    EXPECT_GT(rotation_angle_rad(back.off().linear()), 0.1);
    EXPECT_GT(sigma_m(body), 0.05);
    EXPECT_TRUE(is_covariance(body.cov_T_world_obj));
  }
}

// Between two absences it shows another side: what is measured then is of a guessed frame, and tells nothing of its
// birth.
TEST(Registry, PointsOfAGuessedFrameAreNoneOfItsBirth) {
  Return back;
  back.passage.show_another_side();
  for (int frame = 27; frame <= 34; ++frame) back.step(frame);
  EXPECT_GT(rotation_angle_rad(back.off().linear()), 0.1);
  for (int frame = 35; frame <= 41; ++frame) back.step(frame, false);
  back.passage.start_new_tracks();  // that side again, by other tracks
  for (int frame = 42; frame <= 48; ++frame) {
    const MovingBody& body = back.step(frame);
    ASSERT_EQ(body.id, BodyId{1});
    EXPECT_GT(rotation_angle_rad(back.off().linear()), 0.1);
    EXPECT_GT(sigma_m(body), 0.05) << "frame " << frame;
  }
  // And the first side at last.
  for (int frame = 49; frame <= 55; ++frame) back.step(frame, false);
  back.passage.show_another_side();
  for (int frame = 56; frame <= 60; ++frame) back.step(frame);
  EXPECT_LT(rotation_angle_rad(back.off().linear()), 0.02);
  EXPECT_LT(sigma_m(back.passage.bodies()[0]), 0.01);
}

TEST(Registry, AMissedFrameIsForgottenWhenItsTracksGoOn) {
  PointWorld world = slow_camera(100);
  world.add_body(40, {-0.1, 0, 2.0}, 0.25, twist(0.01, 0, 0.002, 0, 0.01, 0));
  Passage passage(world, false);
  for (int frame = 1; frame <= 15; ++frame) passage.step(frame);
  const double before_m = sigma_m(passage.bodies()[0]);
  for (int frame = 16; frame <= 48; ++frame) passage.step(frame, frame % 7 != 0);
  ASSERT_EQ(passage.bodies().size(), 1U);
  EXPECT_LT(sigma_m(passage.bodies()[0]), 2 * before_m);
}

TEST(Registry, AfterALossBodiesAreWhereTheyAreRecognisedNotWhereTheyWereExpected) {
  PointWorld world = slow_camera(100);
  world.add_body(40, {-0.1, 0, 2.0}, 0.25, twist(0.02, 0, 0.01, 0, 0.01, 0));
  Passage passage(world);
  for (int frame = 1; frame <= 8; ++frame) passage.step(frame);
  ASSERT_EQ(passage.bodies().size(), 1U);
  ASSERT_EQ(passage.bodies()[0].phase, ObjectPhase::confirmed);
  Rigid3 T_true = passage.bodies()[0].T_world_obj;
  // Four steps of which nothing is known: 90 mm of the body's way.
  for (int frame = 9; frame <= 12; ++frame) passage.lose();
  ASSERT_EQ(passage.bodies().size(), 1U);
  EXPECT_EQ(passage.bodies()[0].phase, ObjectPhase::coasting);
  EXPECT_FALSE(passage.bodies()[0].place_known);
  for (int frame = 9; frame <= 12; ++frame) T_true = passage.view().M_world[1] * T_true;
  for (int frame = 13; frame <= 16; ++frame) {
    passage.step(frame);
    T_true = passage.view().M_world[1] * T_true;
    ASSERT_EQ(passage.bodies().size(), 1U);
    const MovingBody& body = passage.bodies()[0];
    EXPECT_EQ(body.id, BodyId{1});
    EXPECT_TRUE(body.measured && body.place_known);
    const Eigen::Vector3d center = body.T_world_obj * body.centroid_obj;
    EXPECT_LT((body.M_world * center - passage.view().M_world[1] * center).norm(), 4 * 0.0013) << "frame " << frame;
    EXPECT_LT((body.T_world_obj.translation() - T_true.translation()).norm(), 0.01) << "frame " << frame;
  }
}

TEST(Registry, AfterMissedFramesTheMotionIsThatOfOneStepAndThePlaceNoBetterThanItIs) {
  for (const int missed : {1, 3, 8}) {
    for (const bool same_tracks : {true, false}) {
      PointWorld world(100);
      world.twist_cam = twist(0.02, 0.005, 0.01, 0.001, -0.002, 0.001);
      world.add_body(40, {-0.1, 0, 2.0}, 0.25, twist(0.015, 0, 0.005, 0, 0.01, 0));
      Passage passage(world);
      for (int frame = 1; frame <= 8; ++frame) passage.step(frame);
      ASSERT_EQ(passage.bodies().size(), 1U);
      Rigid3 T_true = passage.bodies()[0].T_world_obj;
      for (int frame = 9; frame < 9 + missed; ++frame) passage.step(frame, false);
      if (!same_tracks) passage.forget_tracks();
      passage.step(9 + missed);
      ASSERT_EQ(passage.bodies().size(), 1U);
      const MovingBody& body = passage.bodies()[0];
      ASSERT_TRUE(body.measured);
      const Eigen::Vector3d center = body.T_world_obj * body.centroid_obj;
      const Eigen::Vector3d moved = body.M_world * center - passage.view().M_world[1] * center;
      EXPECT_LT(moved.norm(), 0.006) << missed << " missed, same tracks " << same_tracks;
      const double sigma = std::sqrt(body.cov_T_world_obj.topLeftCorner<3, 3>().trace());
      for (int k = 0; k <= missed; ++k) T_true = passage.view().M_world[1] * T_true;
      EXPECT_LT((body.T_world_obj.translation() - T_true.translation()).norm(), 4 * sigma) << missed << " missed";
    }
  }
}

TEST(Registry, ALossEndsWhatWasNotYetAnObject) {
  PointWorld world = slow_camera(100);
  world.add_body(40, {0, 0, 2.0}, 0.25, twist(0.02, 0, 0, 0, 0, 0));
  Passage passage(world);
  passage.step(1);
  ASSERT_EQ(passage.bodies().size(), 1U);
  ASSERT_EQ(passage.bodies()[0].phase, ObjectPhase::tentative);
  passage.lose();
  EXPECT_TRUE(passage.bodies().empty());
}

TEST(Registry, ATentativeBodyMayMissAFrame) {
  PointWorld world = slow_camera(100);
  world.add_body(40, {0, 0, 2.0}, 0.25, twist(0.02, 0, 0, 0, 0, 0));
  Passage passage(world);
  passage.step(1);
  passage.step(2, false);
  ASSERT_EQ(passage.bodies().size(), 1U);
  EXPECT_EQ(passage.bodies()[0].phase, ObjectPhase::tentative);
  passage.forget_tracks();
  for (int frame = 3; frame <= 5; ++frame) {
    passage.step(frame);
    ASSERT_EQ(passage.bodies().size(), 1U);
    EXPECT_EQ(passage.bodies()[0].id, BodyId{1});
    EXPECT_EQ(passage.bodies()[0].frames_measured, frame - 1);
  }
  EXPECT_EQ(passage.bodies()[0].phase, ObjectPhase::confirmed);
}

TEST(Registry, AFullTableSaysWhatItRefusesAndMakesRoomAmongTheTentative) {
  PointWorld world = slow_camera(60);
  for (int k = 0; k < kMaxObjects + 2; ++k) {
    const Eigen::Vector3d place(-0.9 + 0.3 * (k % 6) + 0.15, -0.45 + 0.45 * (k / 6), 2.5);
    world.add_body(12, place, 0.08, twist(0.01 * ((k % 3) - 1), 0.02, 0.004 * (k % 4), 0, 0, 0));
  }
  Passage passage(world);
  for (int frame = 1; frame <= 12; ++frame) {
    passage.step(frame);
    ASSERT_EQ(passage.bodies().size(), static_cast<std::size_t>(kMaxObjects)) << "frame " << frame;
    EXPECT_EQ(passage.registry().births_refused(), 2) << "frame " << frame;
  }
  for (const MovingBody& body : passage.bodies()) EXPECT_EQ(body.phase, ObjectPhase::confirmed) << body.id.value;
  // One that is called moving and never does gives way, as the confirmed never do.
  PointWorld restless = slow_camera(60);
  for (int k = 0; k < kMaxObjects + 1; ++k) {
    restless.add_body(12, {-0.75 + 0.3 * (k % 6), -0.45 + 0.45 * (k / 6), 2.5}, 0.08,
                      k == 0 ? twist(0, 0, 0, 0, 0, 0) : twist(0.01 * ((k % 3) - 1), 0.02, 0.004 * (k % 4), 0, 0, 0));
  }
  Passage with_rest(restless);
  for (int frame = 1; frame <= 12; ++frame) with_rest.step(frame, true, 1);
  for (const MovingBody& body : with_rest.bodies()) EXPECT_NE(body.id, BodyId{1});
  for (int frame = 13; frame <= 20; ++frame) with_rest.step(frame);
  ASSERT_EQ(with_rest.bodies().size(), static_cast<std::size_t>(kMaxObjects));
  EXPECT_EQ(with_rest.registry().births_refused(), 0);
  for (const MovingBody& body : with_rest.bodies()) EXPECT_EQ(body.phase, ObjectPhase::confirmed) << body.id.value;
}

TEST(Registry, ABodyOutOfSightForLongEnds) {
  PointWorld world = slow_camera(60);
  world.add_body(40, {0, 0, 2.0}, 0.25, twist(0.02, 0, 0, 0, 0, 0));
  Passage passage(world);
  for (int frame = 1; frame <= 6; ++frame) passage.step(frame);
  ASSERT_EQ(passage.bodies().size(), 1U);
  for (int frame = 7; frame <= 50; ++frame) passage.step(frame, false);
  EXPECT_TRUE(passage.bodies().empty());
}

TEST(Registry, TwoHalvesOfOneBodyBecomeOneAndTwoAbreastStayTwo) {
  for (const double gap_m : {0.02, 0.7}) {
    PointWorld world = slow_camera(60);
    const Vector6d step = twist(0.0, 0.02, 0.005, 0, 0, 0);
    world.add_body(40, {-0.25 - gap_m / 2, 0, 2.0}, 0.25, step);
    world.add_body(40, {0.25 + gap_m / 2, 0, 2.0}, 0.25, step);
    Passage passage(world);
    for (int frame = 1; frame <= 8; ++frame) passage.step(frame);
    EXPECT_EQ(passage.bodies().size(), gap_m < 0.1 ? 1U : 2U) << "gap " << gap_m;
  }
}

// Its ends show on both sides of what hides its middle: by their places they may be two things, and are two bodies
// then.
TEST(Registry, ABodyWhosePartsStandApartForFramesGivesUpTheLesser) {
  PointWorld world = slow_camera(100);
  const Vector6d step = twist(0.02, 0, 0.005, 0, 0, 0);
  world.add_body(40, {-0.45, 0, 2.0}, 0.2, step);
  world.add_body(30, {-0.1, 0, 2.0}, 0.2, step);
  world.add_body(30, {0.25, 0, 2.0}, 0.2, step);
  Passage passage(world);
  for (int frame = 1; frame <= 10; ++frame) passage.step(frame);
  ASSERT_EQ(passage.bodies().size(), 1U);
  EXPECT_GT(passage.bodies()[0].members.size(), 90U);
  const BodyId whole = passage.bodies()[0].id;
  passage.hidden_body = 2;
  for (int frame = 11; frame < 10 + RegistryConfig{}.split_frames; ++frame) passage.step(frame);
  ASSERT_EQ(passage.bodies().size(), 1U);
  EXPECT_GT(passage.bodies()[0].members.size(), 60U);
  for (int frame = 10 + RegistryConfig{}.split_frames; frame <= 20; ++frame) passage.step(frame);
  ASSERT_EQ(passage.bodies().size(), 2U);
  EXPECT_EQ(passage.bodies()[0].id, whole);
  for (const PointIndex i : passage.bodies()[0].members) {
    EXPECT_EQ(passage.view().body_of[static_cast<std::size_t>(i)], 1);
  }
  for (const PointIndex i : passage.bodies()[1].members) {
    EXPECT_EQ(passage.view().body_of[static_cast<std::size_t>(i)], 3);
  }
}

// A cyclist's leg goes another way than he does; a fish that swims beside a diver does too, at some distance.
TEST(Registry, ASmallGroupOnABodyIsAPartOfItAndOneApartIsAnObject) {
  for (const double apart_m : {0.3, 1.0}) {
    PointWorld world = slow_camera(100);
    world.add_body(60, {-0.2, 0, 2.0}, 0.3, twist(0.02, 0, 0.005, 0, 0, 0));
    world.add_body(15, {-0.2 + apart_m, 0, 2.0}, 0.1, twist(0.02, 0.012, 0.005, 0, 0, 0));
    Passage passage(world);
    for (int frame = 1; frame <= 12; ++frame) passage.step(frame);
    ASSERT_GE(passage.bodies().size(), 1U);
    const auto confirmed = std::count_if(passage.bodies().begin(), passage.bodies().end(),
                                         [](const MovingBody& body) { return body.phase == ObjectPhase::confirmed; });
    EXPECT_EQ(confirmed, apart_m > 0.5 ? 2 : 1) << apart_m << " m";
  }
}

}  // namespace
}  // namespace pelorus
