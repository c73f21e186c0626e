// What cannot be written: told before the work where it can be known, with the cure, and nothing of others is touched.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/firmware-host/pelorus/tool_process.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::read_text;
using test::run_tool;
using test::small_scene;
using test::TemporaryFolder;
using test::write_text;

class Output : public testing::Test {
 protected:
  // A run of a few frames in run_, its dive in dive_.
  void replay(int frames = 3) {
    ASSERT_EQ(run_tool("synth " + small_scene(folder_, frames) + " --out " + dive_).exit_code, 0);
    ASSERT_EQ(run_tool("replay " + dive_ + " --out " + run_).exit_code, 0);
  }
  // The tool with its standard output on a full disk; the text is what it says on the other.
  [[nodiscard]] Outcome on_full_disk(const std::string& arguments) const {
    const std::string said = (folder_.path() / "said").string();
    Outcome outcome = run_tool(arguments + " 2>" + said + " >/dev/full #");
    outcome.text = read_text(said);
    return outcome;
  }
  static bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

  TemporaryFolder folder_;
  std::string dive_ = (folder_.path() / "dive").string();
  std::string run_ = (folder_.path() / "run").string();
};

TEST_F(Output, WhatCannotBePrintedIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  replay();
  for (const std::string& arguments : {"eval " + dive_ + " " + run_, "eval " + dive_ + " " + run_ + " --json",
                                       std::string("can dbc"), std::string("doctor --json"), std::string("--help")}) {
    const Outcome outcome = on_full_disk(arguments);
    EXPECT_EQ(outcome.exit_code, 6) << arguments;
    EXPECT_TRUE(holds(outcome.text, "pelorus: standard output: cannot be written")) << arguments << outcome.text;
  }
}

TEST_F(Output, ReportReplacesNoPipeAndFollowsALink) {
  replay();
  const std::string pipe = (folder_.path() / "pipe").string(), link = (folder_.path() / "link.html").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Outcome refused = run_tool("report " + run_ + " --file " + pipe);
  if (holds(refused.text, "without the report page")) GTEST_SKIP() << "built without the page";
  EXPECT_EQ(refused.exit_code, 6) << refused.text;
  EXPECT_TRUE(holds(refused.text, "a pipe or the like")) << refused.text;
  EXPECT_TRUE(fs::is_fifo(pipe));
  const fs::path target = folder_.path() / "kept" / "page.html";
  write_text(target, "earlier");
  fs::create_symlink(target, link);
  EXPECT_EQ(run_tool("report " + run_ + " --file " + link).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_GT(fs::file_size(target), 1000U);
  fs::remove(target);
  const Outcome dangling = run_tool("report " + run_ + " --file " + link);
  EXPECT_EQ(dangling.exit_code, 6) << dangling.text;
  EXPECT_TRUE(holds(dangling.text, "is a link to nothing (remove the link")) << dangling.text;
}

TEST_F(Output, AMissingFolderIsNamed) {
  replay();
  const std::string file = (folder_.path() / "nope" / "x").string();
  for (const std::string& arguments :
       {"export " + run_ + " --format csv --out " + file, "calib convert " + dive_ + " --to opencv --out " + file,
        "calib convert " + dive_ + " --to ros --out " + file, "calib convert " + dive_ + " --to euroc --out " + file}) {
    const Outcome outcome = run_tool(arguments);
    EXPECT_EQ(outcome.exit_code, 6) << arguments;
    EXPECT_TRUE(holds(outcome.text, "nope ")) << outcome.text;
    EXPECT_TRUE(holds(outcome.text, "(make that folder, or check the path)")) << outcome.text;
    EXPECT_FALSE(fs::exists(folder_.path() / "nope")) << arguments;
  }
}

// A limit on the size of files stands for a disk that fills up: the same calls fail.
TEST_F(Output, PointCloudsAreWrittenAllOrNone) {
  replay();
  const std::string point = ",1,0.1,0.2,0.3,0.01,3,1,2,100\n";
  std::string points = "object_id,track,p_x,p_y,p_z,spread_m,views,first_ns,last_ns,gray\n0" + point;
  for (int i = 0; i < 400; ++i) points += "1" + point;
  write_text(run_ + "/points.csv", points);
  const std::string clouds = (folder_.path() / "clouds").string();
  const std::string arguments = "export " + run_ + " --format ply --out " + clouds;
  const Outcome full = run_tool(arguments, "trap '' XFSZ; ulimit -f 4; ");
  EXPECT_EQ(full.exit_code, 6) << full.text;
  EXPECT_TRUE(fs::is_empty(clouds)) << full.text;
  const Outcome again = run_tool(arguments);
  EXPECT_EQ(again.exit_code, 0) << again.text;
  EXPECT_TRUE(fs::exists(clouds + "/scene.ply") && fs::exists(clouds + "/body_1.ply"));
}

TEST_F(Output, APictureIsRefusedBeforeTheWorkWithItsOwnCure) {
  ASSERT_EQ(run_tool("synth " + small_scene(folder_, 3) + " --out " + dive_).exit_code, 0);
  fs::create_directory(folder_.path() / "a.png");
  struct Case {
    std::string name;
    int exit_code;
    const char* said;
  };
  for (const Case& c : {Case{"q.txt", 2, "let it end in .png"}, Case{"a.png", 6, "is a folder"},
                        Case{"nope/q.png", 6, "make that folder"}}) {
    const std::string picture = (folder_.path() / c.name).string();
    for (const std::string& arguments :
         {"calib check " + dive_ + " --out " + picture,
          "bench latency " + dive_ + " --frames 3 --seconds 0.2 --normal --picture " + picture}) {
      const Outcome outcome = run_tool(arguments);
      EXPECT_EQ(outcome.exit_code, c.exit_code) << arguments << "\n" << outcome.text;
      EXPECT_TRUE(holds(outcome.text, c.said)) << outcome.text;
      EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << "one line\n" << outcome.text;
    }
  }
  const fs::path picture = folder_.path() / "q.png";
  EXPECT_EQ(run_tool("calib check " + dive_ + " --out " + picture.string()).exit_code, 0);
  EXPECT_GT(fs::file_size(picture), 100U);
  EXPECT_FALSE(fs::exists(picture.string() + ".partial"));
}

TEST_F(Output, APictureThatDoesNotFitKeepsTheEarlierOne) {
  ASSERT_EQ(run_tool("synth " + small_scene(folder_, 3) + " --out " + dive_).exit_code, 0);
  const fs::path picture = folder_.path() / "q.png";
  write_text(picture, "earlier");
  const Outcome full = run_tool("calib check " + dive_ + " --out " + picture.string(), "trap '' XFSZ; ulimit -f 1; ");
  EXPECT_EQ(full.exit_code, 6) << full.text;
  EXPECT_TRUE(holds(full.text, "free space")) << full.text;
  EXPECT_EQ(read_text(picture), "earlier");
}

TEST_F(Output, AblateRefusesAFolderThatIsNotItsOwnBeforeItRuns) {
  replay();
  write_text(folder_.path() / "file", "");
  const std::string ablate = "ablate " + dive_ + " --frames 3 --only net_filter --out ";
  const Outcome file = run_tool(ablate + (folder_.path() / "file" / "x").string());
  EXPECT_EQ(file.exit_code, 6) << file.text;
  EXPECT_FALSE(holds(file.text, "runs ")) << file.text;
  for (const char* overwrite : {"", " --overwrite"}) {
    const Outcome foreign = run_tool(ablate + run_ + overwrite);
    EXPECT_EQ(foreign.exit_code, 6) << foreign.text;
    EXPECT_FALSE(fs::exists(run_ + "/all_on")) << foreign.text;
    EXPECT_TRUE(fs::exists(run_ + "/camera.tum"));
  }
  const std::string own = (folder_.path() / "ablation").string();
  EXPECT_EQ(run_tool(ablate + own).exit_code, 0);
  const Outcome taken = run_tool(ablate + own);
  EXPECT_EQ(taken.exit_code, 6);
  EXPECT_TRUE(holds(taken.text, "--overwrite")) << taken.text;
  EXPECT_EQ(run_tool(ablate + own + " --overwrite").exit_code, 0);
}

// A demo renders its dive under the same name.
TEST_F(Output, AblateLeavesTheDiveOfADemoAlone) {
  replay();
  const std::string scene = (folder_.path() / "scene.yaml").string();
  const fs::path demo = folder_.path() / "demo";
  for (const char* name : {"dataset", "dataset.partial"}) {
    fs::remove_all(demo);
    write_text(demo / name / "mav0" / "mine", "kept");
    const Outcome foreign = run_tool("ablate " + scene + " --only net_filter --overwrite --out " + demo.string());
    EXPECT_EQ(foreign.exit_code, 6) << foreign.text;
    EXPECT_TRUE(holds(foreign.text, "something else than an earlier ablation")) << foreign.text;
    EXPECT_EQ(read_text(demo / name / "mav0" / "mine"), "kept");
  }
}

// With --overwrite too what is wrong is told, not that something else is there.
TEST_F(Output, AblateTellsWhyAFolderCannotBeUsed) {
  replay();
  write_text(folder_.path() / "file", "");
  const std::string ablate = "ablate " + dive_ + " --only net_filter --overwrite --out ";
  const Outcome file = run_tool(ablate + (folder_.path() / "file").string());
  EXPECT_EQ(file.exit_code, 6) << file.text;
  EXPECT_TRUE(holds(file.text, "is a file, not a folder")) << file.text;
}

TEST_F(Output, AblateOnAFullDiskHasTheCodeOfOutput) {
  ASSERT_EQ(run_tool("synth " + small_scene(folder_, 20) + " --out " + dive_).exit_code, 0);
  const Outcome full = run_tool("ablate " + dive_ + " --only net_filter --out " + run_, "trap '' XFSZ; ulimit -f 4; ");
  EXPECT_EQ(full.exit_code, 6) << full.text;
  EXPECT_FALSE(holds(full.text, "runs ")) << full.text;
}

}  // namespace
}  // namespace pelorus
