// Goals belong to the recording: where they come from, and what the table makes of them.
#include "firmware-host/pelorus/eval/eval_goals.h"

#include <gtest/gtest.h>

#include "firmware-host/pelorus/eval/eval_json.h"
#include "firmware-host/pelorus/eval/eval_table.h"
#include "firmware-host/pelorus/replay/replay_dive.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::TemporaryFolder;
using test::write_text;

constexpr const char* kScene = PELORUS_SOURCE_DIR "/config/scenes/";

Goals shipped(const std::string& scene) {
  const Result<Goals> goals = goals_of(kScene + scene + ".yaml");
  EXPECT_TRUE(goals.ok()) << goals.error().message();
  return goals.ok() ? goals.value() : Goals{};
}

// Half a millimetre a step, five absolute, over four metres of a synthetic dive.
RunEvaluation dive_run() {
  RunEvaluation run;
  run.has_truth = run.exact_truth = true;
  run.evaluation.camera.emplace();
  run.evaluation.camera->path_length_m = 4;
  run.evaluation.camera->step_m.mean = 0.0002;
  run.evaluation.camera->absolute_m.mean = 0.003;
  run.evaluation.camera->final_drift_percent = 1.2;
  run.evaluation.knows_bodies = true;
  return run;
}

// The line of the table that begins with `name`.
std::string line_of(const RunEvaluation& run, const std::string& name) {
  const std::string table = to_table(run);
  const std::size_t start = table.find("\n  " + name);
  EXPECT_NE(start, std::string::npos) << name << " in\n" << table;
  return start == std::string::npos ? "" : table.substr(start + 1, table.find('\n', start + 1) - start - 1);
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(EvalGoals, ClearAndTurbidWaterHaveTheirOwn) {
  EXPECT_EQ(shipped("paper").camera_step_m, 4e-5);
  EXPECT_EQ(shipped("paper").camera_absolute_m, 4e-4);
  EXPECT_EQ(shipped("turbid").camera_step_m, 3e-4);
  EXPECT_EQ(shipped("turbid").camera_absolute_m, 5e-3);
}

TEST(EvalGoals, EveryShippedSceneHasSome) {
  for (const auto& entry : std::filesystem::directory_iterator(kScene)) {
    if (entry.path().extension() != ".yaml") continue;
    const Result<Goals> goals = goals_of(entry.path().string());
    ASSERT_TRUE(goals.ok()) << goals.error().message();
    EXPECT_TRUE(goals.value().camera_step_m && goals.value().camera_absolute_path_m) << entry.path();
  }
}

TEST(EvalGoals, TheSameFiguresAreJudgedByTheRecordingsGoals) {
  RunEvaluation run = dive_run();
  run.goals = shipped("paper");
  EXPECT_TRUE(holds(line_of(run, "step error, mean"), "< 0.004 cm MISSED")) << line_of(run, "step error, mean");
  EXPECT_TRUE(holds(line_of(run, "absolute error, mean"), "< 0.04 cm  MISSED"));
  run.goals = shipped("turbid");
  EXPECT_TRUE(holds(line_of(run, "step error, mean"), "< 0.03 cm  ok")) << line_of(run, "step error, mean");
  EXPECT_TRUE(holds(line_of(run, "absolute error, mean"), "< 0.5 cm   ok"));
}

TEST(EvalGoals, WithoutGoalsNothingIsJudged) {
  const std::string table = to_table(dive_run());
  EXPECT_FALSE(holds(table, "MISSED")) << table;
  EXPECT_FALSE(holds(table, "ok")) << table;
  EXPECT_FALSE(holds(table, "<")) << table;
}

TEST(EvalGoals, AnAbsoluteGoalDoesNotReachBeyondThePathItWasSetFor) {
  RunEvaluation run = dive_run();
  run.goals = shipped("paper");
  run.evaluation.camera->path_length_m = 13;
  EXPECT_FALSE(holds(line_of(run, "absolute error, mean"), "<"));
  EXPECT_TRUE(holds(line_of(run, "step error, mean"), "MISSED")) << "a step is a step on any path";
}

TEST(EvalGoals, BodiesAndCountsToo) {
  RunEvaluation run = dive_run();
  run.evaluation.bodies.emplace_back();
  run.evaluation.tracking.right_count_share = 0.96;
  run.evaluation.tracking.false_objects.emplace_back();
  EXPECT_FALSE(holds(to_table(run), "\n  goal ")) << "no row without goals";
  run.goals = shipped("paper");
  EXPECT_EQ(line_of(run, "goal "),
            "  goal          < 0.05 < 0.05                  < 0.5  < 0.3                   > 95 %        0             "
            "    6  one");
  EXPECT_TRUE(holds(line_of(run, "right number of motions"), "> 97 %     MISSED"));
  EXPECT_TRUE(holds(line_of(run, "false objects"), "MISSED"));
  run.goals.false_objects = 1;
  EXPECT_TRUE(holds(line_of(run, "false objects"), "ok"));
}

TEST(EvalGoals, WhatIsUnknownIsNullAndADash) {
  RunEvaluation run = dive_run();
  run.evaluation.camera->final_drift_percent.reset();
  run.evaluation.bodies.emplace_back();  // never on show
  const std::string json = to_json(run);
  for (const char* name : {"final_drift_percent", "right_count_share", "right_count_settled_share", "coverage"}) {
    EXPECT_TRUE(holds(json, "\"" + std::string(name) + "\":null")) << name << json;
  }
  EXPECT_FALSE(holds(to_table(run), "final drift over the path"));
  EXPECT_TRUE(holds(line_of(run, "  1 s after each"), " -"));
  EXPECT_FALSE(holds(line_of(run, "right number of motions"), "%"));
}

TEST(EvalGoals, DriftOfARoad) {
  RunEvaluation run = dive_run();
  run.exact_truth = false;
  run.goals.camera_drift_percent = 1.5;
  EXPECT_TRUE(holds(line_of(run, "final drift over the path"), "< 1.5 %    ok"));
  run.goals.camera_drift_percent = 1;
  EXPECT_TRUE(holds(line_of(run, "final drift over the path"), "< 1 %      MISSED"));
}

TEST(EvalGoals, JsonTellsThem) {
  RunEvaluation run = dive_run();
  EXPECT_TRUE(holds(to_json(run), "\"goals\":{}"));
  run.goals.camera_drift_percent = 1.5;
  EXPECT_TRUE(holds(to_json(run), "\"goals\":{\"camera_drift_percent\":1.5}")) << to_json(run);
}

TEST(EvalGoals, ARenderedDiveBringsThoseOfItsScene) {
  const TemporaryFolder folder;
  std::string scene = test::read_text(PELORUS_SOURCE_DIR "/tests/golden/small_dive.yaml");
  write_text(folder.path() / "plain.yaml", scene);
  ASSERT_TRUE(render_dive((folder.path() / "plain.yaml").string(), 1, folder.path() / "plain").ok());
  EXPECT_EQ(goals_of((folder.path() / "plain").string()).value(), Goals{});
  write_text(folder.path() / "held.yaml", scene + "\ngoals: {camera_step_m: 0.000125, right_count_percent: 91.5}\n");
  ASSERT_TRUE(render_dive((folder.path() / "held.yaml").string(), 1, folder.path() / "held").ok());
  Goals expected;
  expected.camera_step_m = 0.000125;
  expected.right_count_percent = 91.5;
  EXPECT_EQ(goals_of((folder.path() / "held").string()).value(), expected);
  EXPECT_EQ(goals_of((folder.path() / "held" / "mav0").string()).value(), expected);
}

TEST(EvalGoals, WrongKeysAreToldWithTheirLine) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "mav0" / "cam0");
  std::filesystem::create_directories(folder.path() / "mav0" / "cam1");
  write_text(folder.path() / "mav0" / "cam0" / "data.csv", "");
  write_text(folder.path() / "mav0" / "cam1" / "data.csv", "");
  write_text(folder.path() / "mav0" / "goals.yaml", "camera_step_m: 1\ncamera_stepp_m: 1\n");
  const Result<Goals> goals = goals_of(folder.path().string());
  ASSERT_FALSE(goals.ok());
  EXPECT_TRUE(holds(goals.error().message(), "goals.yaml:2: unknown key 'camera_stepp_m'")) << goals.error().message();
}

TEST(EvalGoals, TheFilesForRecordedDataCanBeRead) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PELORUS_SOURCE_DIR "/config/goals")) {
    const Result<Goals> goals = synthetic::load_goals(entry.path().string());
    ASSERT_TRUE(goals.ok()) << goals.error().message();
    EXPECT_NE(goals.value(), Goals{}) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 3);
}

}  // namespace
}  // namespace pelorus
