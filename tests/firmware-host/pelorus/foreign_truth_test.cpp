// A run held against the truth of another: by times, by the camera's path, and by what the tool says and returns.
#include <gtest/gtest.h>

#include "firmware-host/pelorus/eval/truth_doubt.h"
#include "tests/core/evaluation/hand_made_run.h"
#include "tests/firmware-host/pelorus/tool_process.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;
using test::hand_made;
using test::HandMade;
using test::Outcome;
using test::read_text;
using test::run_tool;
using test::small_scene;
using test::TemporaryFolder;
using test::write_text;

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string doubt_of(const HandMade& made) { return truth_doubt(evaluate(made.run, made.truth, {})).value_or(""); }

TEST(TruthDoubt, ARunThatFitsItsTruthHasNone) {
  HandMade made = hand_made(20, 1);
  EXPECT_EQ(doubt_of(made), "");
  // Off by a twentieth of the path, as a poor run may be.
  for (std::size_t i = 0; i < made.run.size(); ++i) made.run[i].T_world_cam->translation().z() *= 1.05;
  EXPECT_EQ(doubt_of(made), "");
}

TEST(TruthDoubt, AnotherPathIsDoubted) {
  HandMade made = hand_made(20, 0);
  for (std::size_t i = 0; i < made.run.size(); ++i) made.run[i].T_world_cam->translation().z() *= 1.5;
  EXPECT_TRUE(holds(doubt_of(made), "on a true path of 1.1")) << doubt_of(made);
}

TEST(TruthDoubt, ATruthThatRestsDoesNotSpeakByItsNoise) {
  HandMade made = hand_made(20, 0);
  for (std::size_t i = 0; i < made.run.size(); ++i) {
    made.truth.frames[i].T_truth_cam = test::T_truth_world();
    made.run[i].T_world_cam = test::rigid({i % 2 == 0 ? 0.002 : -0.002, 0, 0}, {0, 0, 0});
  }
  EXPECT_EQ(doubt_of(made), "");
}

TEST(TruthDoubt, TruthOfFewerThanHalfOfThePosesIsDoubted) {
  HandMade made = hand_made(20, 0);
  for (std::size_t i = 9; i < made.run.size(); ++i) made.truth.frames[i].T_truth_cam.reset();
  EXPECT_EQ(frames_with_truth(made.truth), 9U);
  EXPECT_TRUE(holds(doubt_of(made), "only 9 of 20 poses")) << doubt_of(made);
  made.truth.frames[9].T_truth_cam = test::T_truth_world() * test::T_world_cam_at(9);
  EXPECT_EQ(doubt_of(made), "");
}

// A rendered dive with its run, and data sets that are not its own.
class ForeignTruth : public testing::Test {
 protected:
  void SetUp() override {
    const std::string scene = small_scene(folder_, 10);
    ASSERT_EQ(run_tool("synth " + scene + " --out " + dive_.string()).exit_code, 0);
    ASSERT_EQ(run_tool("replay " + dive_.string() + " --out " + out_.string()).exit_code, 0);
  }
  TemporaryFolder folder_;
  fs::path dive_ = folder_.path() / "dive";
  fs::path out_ = folder_.path() / "out";
};

TEST_F(ForeignTruth, OfOtherTimesIsRefusedAndNoPageWritten) {
  const fs::path file = dive_ / "mav0" / "state_groundtruth_estimate0" / "data.csv";
  std::string truth = read_text(file);
  for (std::size_t at = 0; (at = truth.find("\n16", at)) != std::string::npos;) truth.replace(at, 3, "\n15");
  write_text(file, truth);
  const std::string names[] = {"report " + out_.string() + " " + dive_.string(),
                               "eval " + dive_.string() + " " + out_.string()};
  for (const std::string& command : names) {
    const Outcome outcome = run_tool(command);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
    EXPECT_TRUE(holds(outcome.text, "truth of the same time")) << outcome.text;
  }
  EXPECT_FALSE(fs::exists(out_ / "report.html"));
}

TEST_F(ForeignTruth, OfAnotherPathIsWarnedOfAndToldOnThePage) {
  std::string scene = read_text(folder_.path() / "scene.yaml");
  scene.replace(scene.find("[0.2, 0, 0]"), 11, "[0.0, 0.6, 0]");
  write_text(folder_.path() / "other.yaml", scene);
  const std::string other = (folder_.path() / "other.yaml").string();
  const Outcome table = run_tool("eval " + other + " " + out_.string());
  EXPECT_TRUE(holds(table.text, "pelorus: warning: the camera is off by ")) << table.text;
  EXPECT_TRUE(holds(table.text, "       DOUBTFUL: ")) << table.text;
  EXPECT_TRUE(holds(run_tool("eval --json " + other + " " + out_.string()).text, "\"truth_doubt\":\"the camera"));
  EXPECT_TRUE(holds(run_tool("eval --json " + dive_.string() + " " + out_.string()).text, "\"truth_doubt\":null"));
  const Outcome page = run_tool("report " + out_.string() + " " + other);
  if (!fs::exists(out_ / "report.html")) GTEST_SKIP() << "built without the report page";
  EXPECT_TRUE(holds(page.text, "pelorus: warning: the camera is off by ")) << page.text;
  EXPECT_TRUE(holds(read_text(out_ / "report.html"), "The truth is DOUBTFUL: "));
}

}  // namespace
}  // namespace pelorus
