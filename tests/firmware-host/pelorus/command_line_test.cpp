// The tool as a user meets it: exit codes, messages, files.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>

#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::TemporaryFolder;
using test::write_text;

struct Outcome {
  int exit_code = 0;
  std::string text;  // stdout and stderr
};

Outcome run_tool(const std::string& arguments) {
  Outcome outcome;
  const std::string command = std::string(PELORUS_TOOL) + " " + arguments + " 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 512> part{};
  while (pipe && std::fgets(part.data(), part.size(), pipe)) outcome.text += part.data();
  const int status = pipe ? pclose(pipe) : -1;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

// A flat, small, quick scene of a few frames.
std::string small_scene(const TemporaryFolder& folder, int frames) {
  const std::string scene = (folder.path() / "scene.yaml").string();
  write_text(scene, "name: small\nframes: " + std::to_string(frames) +
                        "\n"
                        "camera: {width_px: 160, height_px: 120, f_px: 120, baseline_m: 0.12}\n"
                        "vehicle:\n  step_s: 1\n  p_m: [[0, 0, 0], [0.2, 0, 0], [0.4, 0, 0], [0.6, 0, 0]]\n"
                        "  rpy_deg: [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n");
  return scene;
}

TEST(CommandLine, EveryVerbExplainsItself) {
  for (const char* verb : {"replay", "eval", "ablate", "demo", "can dump", "can dbc", "can export", "doctor"}) {
    const Outcome outcome = run_tool(std::string(verb) + " --help");
    EXPECT_EQ(outcome.exit_code, 0) << verb;
    EXPECT_NE(outcome.text.find("Exit codes"), std::string::npos) << verb;
  }
}

TEST(CommandLine, WrongUsageEndsWithTheDocumentedCode) {
  for (const char* arguments : {"", "replay", "replay a --out b --bogus", "bogus"}) {
    EXPECT_EQ(run_tool(arguments).exit_code, 2) << arguments;
  }
}

TEST(CommandLine, MistypedDataSetLeavesNoOutputBehind) {
  const TemporaryFolder folder;
  const Outcome outcome = run_tool("replay /nonexistent/set --out " + (folder.path() / "out").string());
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.text.find("/nonexistent/set"), std::string::npos) << outcome.text;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST(CommandLine, ReplayThenEvalOfASceneGivesTableAndJson) {
  const TemporaryFolder folder;
  const std::string scene = small_scene(folder, 4);
  const std::string out = (folder.path() / "out").string();
  const Outcome replay = run_tool("replay " + scene + " --out " + out);
  ASSERT_EQ(replay.exit_code, 0) << replay.text;
  EXPECT_NE(replay.text.find("4 stepped"), std::string::npos) << replay.text;
  for (const char* name : {"camera.tum", "objects.csv", "frames.csv", "timing.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / name)) << name;
  }
  const Outcome json = run_tool("eval " + scene + " " + out + " --json");
  EXPECT_NE(json.text.find("\"frames\":4"), std::string::npos) << json.text;
  EXPECT_NE(json.text.find("\"exact_truth\":true"), std::string::npos) << json.text;
}

TEST(CommandLine, OutputWithContentIsRefusedAndOverwriteReplacesIt) {
  const TemporaryFolder folder;
  const std::string scene = small_scene(folder, 2);
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_tool("replay " + scene + " --out " + out).exit_code, 0);
  const Outcome refused = run_tool("replay " + scene + " --out " + out);
  EXPECT_EQ(refused.exit_code, 6);
  EXPECT_NE(refused.text.find("--overwrite"), std::string::npos) << refused.text;
  EXPECT_EQ(run_tool("replay " + scene + " --out " + out + " --overwrite").exit_code, 0);
}

TEST(CommandLine, EvalWithoutTruthSaysWhatItCanAndFails) {
  const TemporaryFolder folder;
  const std::string scene = small_scene(folder, 3);
  const std::string dive = (folder.path() / "dive").string();
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_tool("synth " + scene + " --out " + dive).exit_code, 0);
  ASSERT_EQ(run_tool("replay " + dive + " --out " + out).exit_code, 0);
  std::filesystem::remove_all(std::filesystem::path(dive) / "mav0" / "state_groundtruth_estimate0");
  const Outcome outcome = run_tool("eval " + dive + " " + out);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.text.find("3 frames"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("no truth"), std::string::npos) << outcome.text;
}

TEST(CommandLine, InterruptedReplayEndsWithValidFilesAndCode130) {
  const TemporaryFolder folder;
  const std::string scene = small_scene(folder, 100000);
  const std::string out = (folder.path() / "out").string();
  // The shell waits until frames flow, then interrupts.
  const std::string command = std::string(PELORUS_TOOL) + " replay " + scene + " --out " + out +
                              " >/dev/null 2>&1 & p=$!; while [ $(cat " + out +
                              "/frames.csv 2>/dev/null | wc -l) -lt 3 ]; do kill -0 $p || exit 99; sleep 0.05; done; "
                              "kill -INT $p; wait $p";
  const int status = std::system(("bash -c 'set -m; " + command + "' 2>/dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_EQ(test::read_text(out + "/frames.csv").back(), '\n');
}

TEST(CommandLine, AblateNamesTheStepsWhenAStepIsUnknown) {
  const Outcome outcome = run_tool("ablate paper --only net_filer");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("net_filter"), std::string::npos) << outcome.text;
}

TEST(CommandLine, AblatePrintsARowPerRun) {
  const TemporaryFolder folder;
  const Outcome outcome = run_tool("ablate " + small_scene(folder, 2) + " --only net_filter,ray_filter --json");
  EXPECT_NE(outcome.text.find("\"step_off\":null"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("\"step_off\":\"net_filter\""), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("\"step_off\":\"ray_filter\""), std::string::npos) << outcome.text;
}

TEST(CommandLine, DoctorFailsWhenTheConfiguredSourceIsNotThereAndOnlyThen) {
  const TemporaryFolder folder;
  const std::string config = (folder.path() / "dive.yaml").string();
  write_text(config, "source: {kind: synthetic, path: " PELORUS_SOURCE_DIR
                     "/config/scenes/paper.yaml}\nlcm: {enabled: false}\n"
                     "timing: {deadline_tolerance_ms: 1000}\n");  // of a machine shared with other tests
  const Outcome good = run_tool("doctor --config " + config);
  EXPECT_EQ(good.exit_code, 0) << good.text;
  EXPECT_NE(good.text.find("wake-ups"), std::string::npos) << good.text;
  write_text(config, "source: {path: /nonexistent/dive}\nlcm: {enabled: false}\n");
  const Outcome bad = run_tool("doctor --json --config " + config);
  EXPECT_EQ(bad.exit_code, 1) << bad.text;
  EXPECT_NE(bad.text.find("\"topic\":\"source replay\",\"verdict\":\"FAIL\""), std::string::npos) << bad.text;
  write_text(config, "source: {pathh: x}\n");
  EXPECT_EQ(run_tool("doctor --config " + config).exit_code, 5);
}

TEST(CommandLine, DemoDoesNotTouchAForeignFolder) {
  const TemporaryFolder folder;
  write_text(folder.path() / "thesis.txt", "mine");
  const Outcome outcome = run_tool("demo --out " + folder.path().string());
  EXPECT_EQ(outcome.exit_code, 6);
  EXPECT_NE(outcome.text.find("something else"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace pelorus
