#include "core/evaluation/evaluation.h"

#include <gtest/gtest.h>

#include "tests/core/evaluation/hand_made_run.h"

namespace pelorus {
namespace {

using test::hand_made;
using test::HandMade;

TEST(Evaluate, ReportsCameraAndEveryMovingBody) {
  HandMade made = hand_made(20, 3);
  for (TrueFrame& frame : made.truth.frames) frame.bodies[2].moving = false;
  for (EstimatedFrame& frame : made.run) frame.objects.pop_back();
  const Evaluation evaluation = evaluate(made.run, made.truth, {});
  ASSERT_TRUE(evaluation.camera);
  EXPECT_LT(evaluation.camera->absolute_m.max, 1e-9);
  ASSERT_EQ(evaluation.bodies.size(), 2U) << "the resting body is no body to be tracked";
  EXPECT_EQ(evaluation.bodies[1].name, "1");
  EXPECT_LT(evaluation.bodies[1].motion.since_birth_m.max, 1e-9);
}

TEST(Evaluate, WithoutBodiesInTheTruthNothingIsCalledFalse) {
  HandMade made = hand_made(20, 1);
  made.truth.knows_bodies = false;
  made.truth.bodies.clear();
  for (TrueFrame& frame : made.truth.frames) frame.bodies.clear();
  const Evaluation evaluation = evaluate(made.run, made.truth, {});
  EXPECT_TRUE(evaluation.camera);
  EXPECT_TRUE(evaluation.tracking.false_objects.empty());
  ASSERT_EQ(evaluation.facts.confirmed.size(), 1U);
}

TEST(Evaluate, StaticSceneWithKnownBodiesCallsEveryObjectFalse) {
  HandMade made = hand_made(20, 1);
  made.truth.bodies.clear();
  for (TrueFrame& frame : made.truth.frames) frame.bodies.clear();
  EXPECT_EQ(evaluate(made.run, made.truth, {}).tracking.false_objects.size(), 1U);
}

TEST(RunFacts, CountsWhatTheSystemSaidOfItself) {
  HandMade made = hand_made(10, 2);
  made.run[3].T_world_cam.reset();
  made.run[3].state = VisionState::lost;
  made.run[9].reset_counter = 1;
  made.run[4].frames_missed = 2;
  for (EstimatedFrame& frame : made.run) frame.objects[1].phase = ObjectPhase::tentative;
  const RunFacts facts = run_facts(made.run);
  EXPECT_EQ(facts.frames, 10U);
  EXPECT_EQ(facts.frames_with_pose, 9U);
  EXPECT_EQ(facts.frames_missed, 2U);
  EXPECT_EQ(facts.states[static_cast<std::size_t>(VisionState::lost)], 1U);
  EXPECT_EQ(facts.resets, 1);
  ASSERT_EQ(facts.confirmed.size(), 1U);
  EXPECT_EQ(facts.confirmed[0].value, 1);
}

}  // namespace
}  // namespace pelorus
