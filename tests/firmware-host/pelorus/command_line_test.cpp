// The tool as a user meets it: exit codes, messages, files.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include "tests/firmware-host/pelorus/tool_process.h"

namespace pelorus {
namespace {

using test::Outcome;
using test::run_tool;
using test::small_scene;
using test::TemporaryFolder;
using test::write_text;

TEST(CommandLine, MistypedDataSetLeavesNoOutputBehind) {
  const TemporaryFolder folder;
  const Outcome outcome = run_tool("replay /nonexistent/set --out " + (folder.path() / "out").string());
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.text.find("/nonexistent/set"), std::string::npos) << outcome.text;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST(CommandLine, MistypedPathIsNamedWithWhatIsThere) {
  const TemporaryFolder folder;
  write_text(folder.path() / "dives" / "monday" / "note.txt", "x");
  const std::string there = "cd " + folder.path().string() + " && ";
  for (const char* verb : {"replay dives/mondy --out out", "replay mondy --out out", "ablate dives/mondy"}) {
    const Outcome outcome = run_tool(verb, there);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
    EXPECT_NE(outcome.text.find("mondy: does not exist"), std::string::npos) << outcome.text;
    EXPECT_NE(outcome.text.find("paper"), std::string::npos) << "the shipped scenes\n" << outcome.text;
  }
  EXPECT_NE(run_tool("replay dives/mondy --out out", there).text.find("dives holds monday"), std::string::npos);
  EXPECT_NE(run_tool("replay mondy --out out", there).text.find("this folder holds dives"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
  const Outcome text = run_tool("replay dives/monday/note.txt --out out", there);
  EXPECT_EQ(text.exit_code, 3) << text.text;
  EXPECT_NE(text.text.find("neither an LCM log nor a scene file"), std::string::npos) << text.text;
}

TEST(CommandLine, OverlayEveryImpliesOverlay) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  const Outcome outcome =
      run_tool("replay " + small_scene(folder, 4) + " --out " + out.string() + " --overlay-every 3");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_TRUE(std::filesystem::exists(out / "overlay" / "000000.png"));
  EXPECT_FALSE(std::filesystem::exists(out / "overlay" / "000001.png"));
  EXPECT_TRUE(std::filesystem::exists(out / "overlay" / "000003.png"));
}

TEST(CommandLine, ExchangedPicturesEndReplayBeforeItWrites) {
  const TemporaryFolder folder;
  const std::filesystem::path mav0 = folder.path() / "dive" / "mav0";
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_tool("synth static --frames 3 --out " + (folder.path() / "dive").string()).exit_code, 0);
  std::filesystem::rename(mav0 / "cam0" / "data", mav0 / "keep");
  std::filesystem::rename(mav0 / "cam1" / "data", mav0 / "cam0" / "data");
  std::filesystem::rename(mav0 / "keep", mav0 / "cam1" / "data");
  const Outcome outcome = run_tool("replay " + (folder.path() / "dive").string() + " --out " + out);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.text.find("exchange the two folders"), std::string::npos) << outcome.text;
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(CommandLine, ReplayThenEvalOfASceneGivesTableAndJson) {
  const TemporaryFolder folder;
  const std::string scene = small_scene(folder, 4);
  const std::string out = (folder.path() / "out").string();
  const Outcome replay = run_tool("replay " + scene + " --out " + out);
  ASSERT_EQ(replay.exit_code, 0) << replay.text;
  EXPECT_NE(replay.text.find("4 stepped"), std::string::npos) << replay.text;
  for (const char* name :
       {"camera.tum", "objects.csv", "frames.csv", "timing.csv", "points.csv", "outlines.csv", "lost_pairs.csv"}) {
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
  for (const char* format : {"tum", "kitti", "csv", "mcap"}) {
    ASSERT_EQ(run_tool("export " + out + " --format " + format).exit_code, 0) << format;
  }
  for (const char* name : {"scene.ply", "body_12.ply", "notes.txt"}) test::write_text(out + "/" + name, "older");
  const auto names = [&out] {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(out)) found.insert(entry.path().filename());
    return found;
  };
  const std::set<std::string> with_exports = names();
  EXPECT_EQ(run_tool("replay " + scene + " --out " + out + " --overwrite").exit_code, 0);
  std::set<std::string> gone;
  std::ranges::set_difference(with_exports, names(), std::inserter(gone, gone.end()));
  EXPECT_TRUE(gone.contains("camera.export.tum") && gone.contains("trajectories.csv") && gone.contains("scene.ply"));
  EXPECT_TRUE(gone.contains("body_12.ply"));
  EXPECT_TRUE(gone.contains("run.mcap") && gone.contains("camera.kitti.txt"));
  EXPECT_FALSE(gone.contains("notes.txt")) << "not ours";
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
  EXPECT_NE(outcome.text.find("3 stepped"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("no truth"), std::string::npos) << outcome.text;
}

TEST(CommandLine, InterruptedRenderingLeavesNothingBehindAndTheFolderUsable) {
  const TemporaryFolder folder;
  const std::string scene = small_scene(folder, 100000);
  const std::string dive = (folder.path() / "dive").string();
  const std::string demo = (folder.path() / "demo").string();
  const auto interrupted = [](const std::string& arguments, const std::string& first_image_folder) {
    const std::string command = std::string(PELORUS_TOOL) + " " + arguments + " >/dev/null 2>&1 & p=$!; while [ $(ls " +
                                first_image_folder +
                                " 2>/dev/null | wc -l) -lt 3 ]; do kill -0 $p || exit 99; sleep 0.05; done; "
                                "kill -INT $p; wait $p";
    return WEXITSTATUS(std::system(("bash -c 'set -m; " + command + "' 2>/dev/null").c_str()));
  };
  EXPECT_EQ(interrupted("synth " + scene + " --out " + dive, dive + ".partial/mav0/cam0/data"), 130);
  EXPECT_FALSE(std::filesystem::exists(dive));
  EXPECT_FALSE(std::filesystem::exists(dive + ".partial"));
  const std::string demo_arguments = "demo --scene " + scene + " --out " + demo;
  EXPECT_EQ(interrupted(demo_arguments, demo + "/dataset.partial/mav0/cam0/data"), 130);
  EXPECT_TRUE(std::filesystem::is_empty(demo));
  // What a demo that was killed leaves is a demo's too.
  write_text(demo + "/dataset.partial/mav0/cam0/data.csv", "#");
  EXPECT_EQ(interrupted(demo_arguments, demo + "/dataset.partial/mav0/cam0/data"), 130);
}

TEST(CommandLine, MistypedSceneLeavesNoDemoFolderBehind) {
  const TemporaryFolder folder;
  const std::string demo = (folder.path() / "demo").string();
  EXPECT_EQ(run_tool("demo --scene papr --out " + demo).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(demo));
}

TEST(CommandLine, BadSceneLeavesNoDemoFolderBehind) {
  const TemporaryFolder folder;
  const std::string demo = (folder.path() / "demo").string();
  write_text(folder.path() / "bad.yaml", "name: bad\nframess: 3\n");
  EXPECT_EQ(run_tool("demo --scene " + (folder.path() / "bad.yaml").string() + " --out " + demo).exit_code, 5);
  EXPECT_FALSE(std::filesystem::exists(demo));
}

TEST(CommandLine, AblatePrintsARowPerRun) {
  const TemporaryFolder folder;
  const Outcome outcome = run_tool("ablate " + small_scene(folder, 2) + " --only net_filter,ray_filter --json");
  EXPECT_NE(outcome.text.find("\"step_off\":null"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("\"step_off\":\"net_filter\""), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("\"step_off\":\"ray_filter\""), std::string::npos) << outcome.text;
}

TEST(CommandLine, DemoEndsByNamingTheReportPage) {
  const TemporaryFolder folder;
  const std::string demo = (folder.path() / "demo").string();
  const Outcome outcome = run_tool("demo --scene " + small_scene(folder, 4) + " --out " + demo);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string page = demo + "/results/report.html";
  if (!std::filesystem::exists(page)) GTEST_SKIP() << "built without the page";
  const std::string last = "Report      " + page + " (open it in a browser)\n";
  ASSERT_GT(outcome.text.size(), last.size());
  EXPECT_EQ(outcome.text.substr(outcome.text.size() - last.size()), last);
}

TEST(CommandLine, ALogThatIsDamagedAtItsStartIsSaidToBe) {
  const TemporaryFolder folder;
  const std::string log = (folder.path() / "x.lcmlog").string();
  write_text(log, "damaged");
  for (const char* calibration : {"", " --calib cv.yaml"}) {
    const Outcome outcome = run_tool("replay " + log + calibration + " --out " + (folder.path() / "out").string());
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_NE(outcome.text.find("x.lcmlog: the LCM log is damaged"), std::string::npos) << outcome.text;
  }
}

TEST(CommandLine, ExportWritesEachFormatAndRefusesWhatItCannot) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_tool("replay " + small_scene(folder, 4) + " --out " + out).exit_code, 0);
  for (const char* name :
       {"tum camera.export.tum", "kitti camera.kitti.txt", "csv trajectories.csv", "mcap run.mcap", "ply scene.ply"}) {
    const std::string word(name), format = word.substr(0, word.find(' ')), file = word.substr(word.find(' ') + 1);
    const Outcome done = run_tool("export " + out + " --format " + format);
    EXPECT_EQ(done.exit_code, 0) << done.text;
    EXPECT_GT(std::filesystem::file_size(std::filesystem::path(out) / file), 0U) << name;
    EXPECT_EQ(run_tool("export " + out + " --format " + format).exit_code, 6) << name;  // exists already
    EXPECT_EQ(run_tool("export " + out + " --overwrite --format " + format).exit_code, 0) << name;
  }
  // The trajectory of the run itself, in one spelling.
  EXPECT_EQ(test::read_text(out + "/camera.export.tum"), test::read_text(out + "/camera.tum"));
  EXPECT_TRUE(std::filesystem::exists(out + "/camera.kitti.txt.times"));
  const Outcome nobody = run_tool("export " + out + " --format tum --body 77");
  EXPECT_EQ(nobody.exit_code, 3);
  EXPECT_NE(nobody.text.find("no body 77"), std::string::npos) << nobody.text;
  EXPECT_EQ(run_tool("export " + out + " --format csv --body 1").exit_code, 2);
  EXPECT_EQ(run_tool("export " + out + " --format bag").exit_code, 2);
  EXPECT_NE(run_tool("export " + folder.path().string() + "/nothing --format csv").exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(out + "/body_77.export.tum"));
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

TEST(CommandLine, ReportOfWhatIsNoRunSaysSoAndLeavesNoPage) {
  const TemporaryFolder folder;
  const Outcome outcome = run_tool("report " + folder.path().string());
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.text.find("no camera.tum here"), std::string::npos) << outcome.text;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(CommandLine, ReportOfADamagedRunNamesTheLineAndKeepsTheEarlierPage) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_tool("replay " + small_scene(folder, 3) + " --out " + out).exit_code, 0);
  write_text(out + "/report.html", "earlier");
  write_text(out + "/timing.csv", "seq,timestamp_ns,rectify_us,step_us\n0,0,1\n");
  const Outcome outcome = run_tool("report " + out);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.text.find("timing.csv:2"), std::string::npos) << outcome.text;
  EXPECT_EQ(test::read_text(out + "/report.html"), "earlier");
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
