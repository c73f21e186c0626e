// The tool as a user meets it: exit codes, messages, files.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/firmware-host/pelorus/tool_process.h"

namespace pelorus {
namespace {

using test::Outcome;
using test::run_tool;
using test::small_scene;
using test::TemporaryFolder;
using test::write_text;

TEST(CommandLine, EveryVerbExplainsItself) {
  for (const char* verb :
       {"replay", "eval", "report", "ablate", "demo", "can dump", "can dbc", "can export", "doctor", "export"}) {
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

TEST(CommandLine, WrongUsageNamesTheWordAndTheHelpThatKnowsBetter) {
  struct Case {
    const char* arguments;
    const char* said;
  };
  for (const Case& c : {
           Case{"", "no verb is given (pelorus --help tells"},
           Case{"bogus", "'bogus' is no verb of pelorus (pelorus --help tells"},
           Case{"bogus replay a", "'bogus' is not expected (pelorus --help tells"},
           Case{"--bogus", "'--bogus' is no option of pelorus (pelorus --help tells"},
           Case{"--bogus replay a --out b", "'--bogus' is no option of pelorus (pelorus --help tells"},
           Case{"calib", "no verb is given (pelorus calib --help tells"},
           Case{"calib bogus", "'bogus' is no verb of pelorus calib (pelorus calib --help tells"},
           Case{"can bogus", "'bogus' is no verb of pelorus can (pelorus can --help tells"},
           Case{"bench bogus", "'bogus' is no verb of pelorus bench (pelorus bench --help tells"},
           Case{"bench --bogus", "'--bogus' is no option of pelorus bench (pelorus bench --help tells"},
           Case{"calib check a b", "'b' is not expected (pelorus calib check --help tells"},
           Case{"calib check a -- b", "'b' is not expected (pelorus calib --help tells"},
           Case{"calib convert a --out b --to foo",
                "(give one of: euroc, kalibr, opencv, ros) (pelorus calib convert "},
           Case{"replay a --ou b", "'--ou' is no option of pelorus replay (pelorus replay --help tells"},
           Case{"replay a", "--out is required (pelorus replay --help tells"},
       }) {
    const Outcome outcome = run_tool(c.arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_NE(outcome.text.find(c.said), std::string::npos) << c.arguments << ": " << outcome.text;
  }
}

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

TEST(CommandLine, HelpNamesEverySourceAndExitCode) {
  EXPECT_NE(run_tool("replay --help").text.find("LCM log"), std::string::npos);
  EXPECT_NE(run_tool("demo --help").text.find("3 bad input, 4 calibration"), std::string::npos);
  const std::string synth = run_tool("synth --help").text;
  EXPECT_NE(synth.find("--overwrite"), std::string::npos) << synth;
  EXPECT_EQ(synth.find("--force"), std::string::npos) << synth;
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

TEST(CommandLine, NumbersOutOfRangeAreToldInWords) {
  const Outcome outcome = run_tool("synth static --frames 0 --out out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("'0' is not a number above 0"), std::string::npos) << outcome.text;
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

TEST(CommandLine, ExportWritesEachFormatAndRefusesWhatItCannot) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(run_tool("replay " + small_scene(folder, 4) + " --out " + out).exit_code, 0);
  for (const char* name :
       {"tum camera.export.tum", "kitti camera.kitti.txt", "csv trajectories.csv", "mcap run.mcap"}) {
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
