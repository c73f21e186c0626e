// Moving bodies: membership, identity, merging, recognition (paper 5.2.4). Their table: registry_test.cpp.

#include <gtest/gtest.h>

#include "core/objects/identity.h"
#include "core/objects/membership.h"
#include "core/objects/merge.h"
#include "core/objects/reidentification.h"
#include "core/objects/spread.h"
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

// A body as known after the previous frame of the view: its frame lies at the previous centroid, unturned.
MovingBody body_known(const WorldView& view, int number) {
  MovingBody body{BodyWindowConfig{}};
  body.id = BodyId{number};
  body.measured = true;
  body.phase = ObjectPhase::confirmed;
  body.members = view.members(number);
  body.H_curr_prev = view.H_curr_prev(number);
  body.M_world = view.M_world[static_cast<std::size_t>(number)];
  body.cov_M_world = 1e-6 * Matrix6d::Identity();
  Eigen::AlignedBox3d box;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const PointIndex i : body.members) {
    const Eigen::Vector3d& p_prev = view.pairs[static_cast<std::size_t>(i)].prev.p_cam;
    box.extend(p_prev);
    center += p_prev / static_cast<double>(body.members.size());
  }
  body.T_cam_obj = Rigid3(Eigen::Translation3d(center));
  body.T_world_obj = view.T_world_cam[view.T_world_cam.size() - 2] * body.T_cam_obj;
  body.extent_m = box.sizes();
  for (const PointIndex i : body.members) {
    const PointPair& pair = view.pairs[static_cast<std::size_t>(i)];
    body.model.push_back({pair.track, pair.prev.p_cam - center, descriptor_of(pair.track.value), 1, true, 0});
  }
  return body;
}

WorldView two_bodies(double gap_m, const Vector6d& twist_a, const Vector6d& twist_b) {
  PointWorld world(0);
  world.add_body(40, {-0.25 - gap_m / 2, 0, 2.0}, 0.25, twist_a);
  world.add_body(40, {0.25 + gap_m / 2, 0, 2.0}, 0.25, twist_b);
  return world.observe(3, 0, kSigma_px);
}

struct MembershipRun {
  WorldView view;
  std::vector<PointRole> roles;
  std::vector<BodyId> owner;
  MovingBody body{BodyWindowConfig{}};

  explicit MembershipRun(WorldView v)
      : view(std::move(v)), roles(view.pairs.size(), PointRole::moving), owner(view.pairs.size(), kNoBody) {
    body = body_known(view, 1);
  }
  StageOutcome run(bool by_hull) {
    Membership membership({}, {}, 1000);
    const std::vector<double> chi2(view.pairs.size(), 100.0);
    return membership.run(kRig, view.pairs, roles, chi2, by_hull, 1, body, owner);
  }
};

TEST(Membership, NewPointsInTheHullThatMoveWithTheBodyJoinIt) {
  MembershipRun step(two_bodies(0.5, twist(0.03, 0, 0, 0, 0.02, 0), twist(0, 0.03, 0, 0, 0, 0)));
  const auto former = step.view.members(1);
  for (std::size_t m = 0; m < former.size(); ++m) {
    if (m % 2 == 0) step.view.pairs[static_cast<std::size_t>(former[m])].previous_body = BodyId{1};
  }
  ASSERT_EQ(step.run(true), StageOutcome::ok);
  EXPECT_GE(step.body.members.size(), 38U);
  for (const PointIndex i : step.body.members) {
    EXPECT_EQ(step.view.body_of[static_cast<std::size_t>(i)], 1);
    EXPECT_EQ(step.owner[static_cast<std::size_t>(i)], BodyId{1});
  }
  EXPECT_LT(se3_log(step.body.H_curr_prev * step.view.H_curr_prev(1).inverse()).norm(), 1e-5);
}

TEST(Membership, WithoutTheHullOnlyFormerMembersStay) {
  MembershipRun step(two_bodies(0.5, twist(0.03, 0, 0, 0, 0.02, 0), twist(0, 0.03, 0, 0, 0, 0)));
  const auto former = step.view.members(1);
  for (std::size_t m = 0; m < 20; ++m) step.view.pairs[static_cast<std::size_t>(former[m])].previous_body = BodyId{1};
  ASSERT_EQ(step.run(false), StageOutcome::ok);
  EXPECT_EQ(step.body.members.size(), 20U);
}

TEST(Membership, PointsFarFromTheHullDoNotJoinHoweverTheyMove) {
  MembershipRun step(two_bodies(0.8, twist(0.03, 0, 0, 0, 0, 0), twist(0.03, 0, 0, 0, 0, 0)));
  for (const PointIndex i : step.view.members(1))
    step.view.pairs[static_cast<std::size_t>(i)].previous_body = BodyId{1};
  ASSERT_EQ(step.run(true), StageOutcome::ok);
  EXPECT_EQ(step.body.members, step.view.members(1));
}

TEST(Membership, PointsInTheHullThatMoveOtherwiseOrAreTakenStayOut) {
  // The second body crosses the first one's hull, with more points than it has left: it must not take it over.
  MembershipRun step(two_bodies(-0.45, twist(0.03, 0, 0, 0, 0, 0), twist(0, 0.03, 0, 0, 0, 0)));
  for (const PointIndex i : step.view.members(1))
    step.view.pairs[static_cast<std::size_t>(i)].previous_body = BodyId{1};
  const auto taken = static_cast<std::size_t>(step.view.members(1)[3]);
  step.owner[taken] = BodyId{9};
  ASSERT_EQ(step.run(true), StageOutcome::ok);
  EXPECT_EQ(step.body.members.size(), 39U);
  for (const PointIndex i : step.body.members) EXPECT_EQ(step.view.body_of[static_cast<std::size_t>(i)], 1);
  EXPECT_EQ(step.owner[taken], BodyId{9});
}

TEST(Membership, ThreePointsAreTooFewAndAreReleased) {
  MembershipRun step(two_bodies(0.5, twist(0.03, 0, 0, 0, 0, 0), twist(0, 0.03, 0, 0, 0, 0)));
  for (std::size_t m = 0; m < 3; ++m) step.view.pairs[m].previous_body = BodyId{1};
  EXPECT_EQ(step.run(false), StageOutcome::too_few_points);
  EXPECT_TRUE(step.body.members.empty());
  EXPECT_EQ(std::count(step.owner.begin(), step.owner.end(), kNoBody), std::ssize(step.owner));
}

TEST(Identity, IsTheBodyWhoseMotionMatches) {
  const WorldView view = two_bodies(-0.1, twist(0.03, 0, 0, 0, 0, 0), twist(0, 0.03, 0, 0, 0, 0));
  std::vector<MovingBody> bodies{body_known(view, 1), body_known(view, 2)};
  for (int number = 1; number <= 2; ++number) {
    Group group;
    group.members = view.members(number);
    const IdentityMatch match = identify(kRig, view.pairs, group, bodies, {});
    EXPECT_EQ(match.body, number - 1);
    EXPECT_LT(match.mismatch, 0.1);
  }
}

TEST(Identity, ANewMotionAFarPlaceOrABodyOutOfSightIsNoMatch) {
  const WorldView view = two_bodies(1.2, twist(0.03, 0, 0, 0, 0, 0), twist(0.03, 0, 0, 0, 0, 0));
  std::vector<MovingBody> bodies{body_known(view, 1)};
  Group far;
  far.members = view.members(2);
  EXPECT_EQ(identify(kRig, view.pairs, far, bodies, {}).body, -1);
  Group own;
  own.members = view.members(1);
  bodies[0].measured = false;
  EXPECT_EQ(identify(kRig, view.pairs, own, bodies, {}).body, -1);
  bodies[0].measured = true;
  bodies[0].H_curr_prev = bodies[0].H_curr_prev * Rigid3(Eigen::Translation3d(0, 0.02, 0));
  EXPECT_EQ(identify(kRig, view.pairs, own, bodies, {}).body, -1);
}

TEST(Merge, HalvesThatMoveAlikeAndTouchAreOneAndThoseAbreastAreNot) {
  const Vector6d step = twist(0.03, 0.01, 0, 0, 0, 0);
  for (const double gap_m : {0.02, 0.6}) {
    const WorldView view = two_bodies(gap_m, step, step);
    const MovingBody a = body_known(view, 1);
    const MovingBody b = body_known(view, 2);
    EXPECT_LT(motion_mismatch(a, b), MergeConfig{}.gate_chi2);
    EXPECT_EQ(touching(view.pairs, a, b, {}), gap_m < 0.1);
    EXPECT_EQ(touching(view.pairs, b, a, {}), gap_m < 0.1);
  }
}

TEST(Merge, MismatchGrowsWithDisplacementAndWithRotationInDeviations) {
  const WorldView view = two_bodies(0.02, twist(0.03, 0, 0, 0, 0, 0), twist(0.03, 0.012, 0, 0, 0, 0));
  const MovingBody a = body_known(view, 1);
  MovingBody b = body_known(view, 2);
  // 12 mm at 1 mm deviation on either side: 144 / 2 and the floor for systematic errors, less what rotation takes up.
  EXPECT_GT(motion_mismatch(a, b), 4 * MergeConfig{}.gate_chi2 / 2);
  b.cov_M_world *= 100;
  EXPECT_LT(motion_mismatch(a, b), MergeConfig{}.gate_chi2);
  const Eigen::Translation3d center(b.T_world_obj.translation());
  b.M_world = center * se3_exp(twist(0, 0, 0, 0, 0.3, 0)) * center.inverse() * a.M_world;
  EXPECT_GT(motion_mismatch(a, b), MergeConfig{}.gate_chi2);
}

struct Recognition {
  WorldView view = two_bodies(0.3, twist(0.03, 0, 0.02, 0.01, 0.02, 0), twist(0, 0.03, 0, 0, 0, 0));
  std::vector<MovingBody> bodies;
  std::vector<Rigid3> T_cam_obj_expected;
  std::vector<Track> tracks;
  std::vector<const Track*> track_of_pair;
  Timestamp now{2'000'000'000};

  Recognition() {
    for (int number = 1; number <= 2; ++number) {
      bodies.push_back(body_known(view, number));
      bodies.back().phase = ObjectPhase::coasting;
      bodies.back().measured = false;  // claimed no point in this step
      bodies.back().last_seen = Timestamp{1'000'000'000};
      T_cam_obj_expected.push_back(Rigid3(Eigen::Translation3d(0.1, -0.1, 0)) * bodies.back().T_cam_obj);
    }
    tracks.resize(view.pairs.size());
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      tracks[i].id = TrackId{1000 + i};
      tracks[i].descriptor = descriptor_of(view.pairs[i].track.value);
      tracks[i].laplacian = 1;
      tracks[i].has_descriptor = true;
      track_of_pair.push_back(&tracks[i]);
    }
  }
  Reidentified run(int number) {
    Group group;
    group.members = view.members(number);
    return reidentify(kRig, view.pairs, group, track_of_pair, bodies, T_cam_obj_expected, now, 1, {});
  }
};

TEST(Reidentification, ReturnsTheIdAndThePoseOfTheBodyThatLooksAlike) {
  Recognition recognition;
  for (int number = 1; number <= 2; ++number) {
    const Reidentified found = recognition.run(number);
    ASSERT_EQ(found.body, number - 1);
    EXPECT_EQ(found.placing.matches, 40);
    const Rigid3 T_true =
        recognition.view.H_curr_prev(number) * recognition.bodies[static_cast<std::size_t>(number - 1)].T_cam_obj;
    EXPECT_LT(se3_log(found.placing.T_cam_obj * T_true.inverse()).norm(), 1e-6);
  }
}

// SURF finds a centre beside where it was found before, in both images alike; every tenth match is a neighbour. The
// kernel gives away weight that the covariance does not claim: it is cautious.
TEST(Placing, ItsCovarianceTellsTheErrorWithNeighboursAmongTheMatches) {
  constexpr int kTrials = 100;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 1);
  double nees = 0;
  double worst_rad = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Recognition recognition;
    const std::vector<PointIndex> members = recognition.view.members(1);
    for (std::size_t m = 0; m < members.size(); ++m) {
      const double beside_px = m % 10 == 0 ? 3 : 0;
      const double u_px = beside_px + 0.7 * normal(random);
      const double v_px = 0.7 * normal(random);
      const double disparity_px = 0.1 * normal(random);
      PointPair& pair = recognition.view.pairs[static_cast<std::size_t>(members[m])];
      pair.curr.z_px += Eigen::Vector3d(u_px, v_px, u_px - disparity_px);
      pair.curr.p_cam = kRig.triangulate(pair.curr.z_px);
      pair.sigma_px = 0.05;
    }
    const MovingBody& body = recognition.bodies[0];
    const auto placing = place_by_descriptors(kRig, recognition.view.pairs, members, recognition.track_of_pair, body,
                                              ModelPart::all, static_cast<std::uint64_t>(trial), {});
    ASSERT_TRUE(placing);
    const Rigid3 T_true = recognition.view.H_curr_prev(1) * body.T_cam_obj;
    const Vector6d error = se3_log(placing->T_cam_obj.inverse() * T_true);
    nees += error.dot(placing->cov_obj.ldlt().solve(error)) / kTrials;
    worst_rad = std::max(worst_rad, error.tail<3>().norm());
  }
  EXPECT_GT(nees, 3);
  EXPECT_LT(nees, 6);  // six unknowns
  EXPECT_LT(worst_rad, 0.03);
}

TEST(Placing, OfTheBirthsFrameOnlyWhatWasMeasuredInItCounts) {
  Recognition recognition;
  const std::vector<PointIndex> members = recognition.view.members(1);
  MovingBody& body = recognition.bodies[0];
  for (std::size_t m = 0; m < body.model.size(); ++m) body.model[m].of_birth = m < 10;
  const auto place = [&](ModelPart part) {
    return place_by_descriptors(kRig, recognition.view.pairs, members, recognition.track_of_pair, body, part, 1, {});
  };
  EXPECT_EQ(place(ModelPart::all)->matches, 40);
  EXPECT_EQ(place(ModelPart::of_birth)->matches, 10);
  for (ModelPoint& point : body.model) point.of_birth = false;
  EXPECT_FALSE(place(ModelPart::of_birth));
}

TEST(Reidentification, StrangersAreRefused) {
  Recognition recognition;
  for (std::size_t i = 0; i < recognition.tracks.size(); ++i) {
    recognition.tracks[i].descriptor = descriptor_of(5000 + i);
  }
  EXPECT_EQ(recognition.run(1).body, -1);
}

TEST(Reidentification, AlikePatchesInAnotherArrangementAreRefused) {
  Recognition recognition;
  std::vector<PointIndex> members = recognition.view.members(1);
  std::vector<SurfDescriptor> descriptors;
  for (const PointIndex i : members) descriptors.push_back(recognition.tracks[static_cast<std::size_t>(i)].descriptor);
  std::shuffle(descriptors.begin(), descriptors.end(), std::mt19937_64(8));
  for (std::size_t m = 0; m < members.size(); ++m) {
    recognition.tracks[static_cast<std::size_t>(members[m])].descriptor = descriptors[m];
  }
  EXPECT_EQ(recognition.run(1).body, -1);
}

TEST(Reidentification, ABodyInSightOrExpectedElsewhereIsNotACandidate) {
  Recognition recognition;
  ASSERT_EQ(recognition.run(1).body, 0);
  recognition.bodies[0].measured = true;
  EXPECT_EQ(recognition.run(1).body, -1);
  recognition.bodies[0].measured = false;
  recognition.T_cam_obj_expected[0] = Rigid3(Eigen::Translation3d(3, 0, 0)) * recognition.T_cam_obj_expected[0];
  EXPECT_EQ(recognition.run(1).body, -1);
}

// What descriptors cannot tell, motion may: the group goes where the body is expected to go.
struct MotionRecognition : Recognition {
  Reidentified by_motion(int number) {
    Group group;
    group.members = view.members(number);
    const Rigid3 H_static = view.H_curr_prev(0);
    return recognise_motion(kRig, view.pairs, group, bodies, T_cam_obj_expected, H_static, now, {});
  }
};

TEST(MotionRecognition, TheBodyThatWasToMoveSoIsItWithTheExpectedPoseAndAllItsDoubt) {
  MotionRecognition recognition;
  const MovingBody& body = recognition.bodies[0];
  const Matrix6d doubt = 0.04 * Matrix6d::Identity();  // in the body's frame
  recognition.bodies[0].cov_T_world_obj = transported(body.T_world_obj, doubt);
  const Reidentified found = recognition.by_motion(1);
  ASSERT_EQ(found.body, 0);
  EXPECT_EQ(found.placing.matches, 0);
  EXPECT_EQ(found.placing.T_cam_obj.matrix(), recognition.T_cam_obj_expected[0].matrix());
  EXPECT_TRUE(found.placing.cov_obj.isApprox(doubt, 1e-9));
  EXPECT_EQ(recognition.by_motion(2).body, 1);
}

TEST(MotionRecognition, AnotherMotionAnotherPlaceOrNoPlaceIsNobody) {
  const auto with = [](auto&& change) {
    MotionRecognition recognition;
    change(recognition);
    return recognition.by_motion(1).body;
  };
  ASSERT_EQ(with([](MotionRecognition&) {}), 0);
  // 20 mm across at 2 m: 8 px.
  EXPECT_EQ(with([](MotionRecognition& r) {
              r.bodies[0].H_curr_prev = Rigid3(Eigen::Translation3d(0, 0.02, 0)) * r.bodies[0].H_curr_prev;
            }),
            -1);
  EXPECT_EQ(with([](MotionRecognition& r) {
              r.T_cam_obj_expected[0] = Rigid3(Eigen::Translation3d(0, 1.0, 0)) * r.T_cam_obj_expected[0];
            }),
            -1);
  EXPECT_EQ(with([](MotionRecognition& r) { r.bodies[0].place_known = false; }), -1);
  EXPECT_EQ(with([](MotionRecognition& r) { r.bodies[0].measured = true; }), -1);
}

TEST(MotionRecognition, WhatMovesLittleMoreThanTheWorldIsNotToldFromItByMotion) {
  MotionRecognition recognition;
  // 2 mm a step: 0.8 px against the scene; a miss of 0.4 px is half of that, though far below motion_px.
  recognition.view = two_bodies(0.3, twist(0.002, 0, 0, 0, 0, 0), twist(0, 0.03, 0, 0, 0, 0));
  MovingBody& body = recognition.bodies[0];
  body.H_curr_prev = recognition.view.H_curr_prev(1);
  EXPECT_EQ(recognition.by_motion(1).body, 0);
  body.H_curr_prev = Rigid3(Eigen::Translation3d(0, 0.001, 0)) * body.H_curr_prev;
  EXPECT_EQ(recognition.by_motion(1).body, -1);
}

TEST(Spread, IsTheDeviationAcrossALineAndStaticPointsInsideAreCounted) {
  std::vector<PointPair> pairs;
  const auto add = [&](double u, double v) {
    PointPair pair;
    pair.past.fill(Eigen::Vector3d::Zero());
    pair.curr.z_px = {u, v, u - 30};
    pairs.push_back(pair);
  };
  // A turned rectangle: deviations 50 along, 6 across.
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-1.0, 1.0}) add(500 + 0.8 * 50 * s - 0.6 * 6 * t, 400 + 0.6 * 50 * s + 0.8 * 6 * t);
  }
  const std::vector<PointIndex> members{0, 1, 2, 3};
  EXPECT_NEAR(spread_px(pairs, members), 6.0, 1e-9);
  add(500, 400);
  add(510, 407);
  add(500, 480);
  std::vector<PointRole> roles(7, PointRole::fixed);
  for (std::size_t i = 0; i < 4; ++i) roles[i] = PointRole::moving;
  EXPECT_DOUBLE_EQ(static_inside(pairs, roles, members), 0.5);
  roles[5] = PointRole::moving;
  EXPECT_DOUBLE_EQ(static_inside(pairs, roles, members), 0.25);
}

}  // namespace
}  // namespace pelorus
