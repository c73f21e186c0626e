// Recordings that lack pairs or break off, disks that are full: exit codes, what is said, and what later verbs make of
// it.
#include <gtest/gtest.h>

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

constexpr std::int64_t kStart_ns = 1'600'000'000'000'000'000;
constexpr std::int64_t kPeriod_ns = 100'000'000;

// A rendered dive whose pictures may be taken away or spoiled.
class IncompleteRun : public testing::Test {
 protected:
  void render(int frames) {
    const Outcome outcome = run_tool("synth " + small_scene(folder_, frames) + " --out " + dive_.string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  [[nodiscard]] static std::int64_t time_ns(int frame) { return kStart_ns + frame * kPeriod_ns; }
  [[nodiscard]] fs::path image(int camera, int frame) const {
    const fs::path file =
        dive_ / "mav0" / ("cam" + std::to_string(camera)) / "data" / (std::to_string(time_ns(frame)) + ".png");
    EXPECT_TRUE(fs::exists(file)) << file;
    return file;
  }
  void spoil(int camera, int frame) const {
    const fs::path file = image(camera, frame);
    fs::resize_file(file, fs::file_size(file) / 2);
  }
  [[nodiscard]] Outcome replay(const std::string& more = "", const std::string& before = "") const {
    return run_tool("replay " + dive_.string() + " --overwrite --out " + out_.string() + more, before);
  }
  [[nodiscard]] Outcome tool(const std::string& arguments) const { return run_tool(arguments); }
  // What eval, report and export say of the run in out_.
  void expect_told(const std::string& reason) const {
    const Outcome table = tool("eval " + dive_.string() + " " + out_.string());
    EXPECT_TRUE(holds(table.text, "the run is INCOMPLETE: ")) << table.text;
    EXPECT_TRUE(holds(table.text, "       INCOMPLETE: ")) << "in the table too\n" << table.text;
    EXPECT_TRUE(holds(table.text, reason)) << table.text;
    EXPECT_EQ(table.exit_code, 3) << "not the code of a whole run";
    EXPECT_TRUE(holds(tool("eval --json " + dive_.string() + " " + out_.string()).text, "\"incomplete\":\""));
    const Outcome exported = tool("export " + out_.string() + " --overwrite --format csv");
    EXPECT_TRUE(holds(exported.text, "the run is INCOMPLETE: ")) << exported.text;
    EXPECT_EQ(exported.exit_code, 3);
    EXPECT_TRUE(fs::exists(out_ / "trajectories.csv")) << exported.text;
    const Outcome page = tool("report " + out_.string());
    EXPECT_TRUE(holds(page.text, "the run is INCOMPLETE: ")) << page.text;
    EXPECT_EQ(page.exit_code, 3);
    if (fs::exists(out_ / "report.html")) {  // not built without the page
      EXPECT_TRUE(holds(read_text(out_ / "report.html"), "This run is INCOMPLETE: "));
    }
  }
  static bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

  TemporaryFolder folder_;
  fs::path dive_ = folder_.path() / "dive";
  fs::path out_ = folder_.path() / "out";
};

TEST_F(IncompleteRun, AWholeRecordingLeavesNoMark) {
  render(4);
  const Outcome outcome = replay();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_FALSE(holds(outcome.text, "finished, but")) << outcome.text;
  EXPECT_FALSE(fs::exists(out_ / "INCOMPLETE"));
  EXPECT_FALSE(holds(tool("eval " + dive_.string() + " " + out_.string()).text, "INCOMPLETE"));
}

// One in the middle, one at the very start, one at the very end.
TEST_F(IncompleteRun, ASingleMissingImageMakesTheCodeThree) {
  for (const int lost : {3, 0, 7}) {
    fs::remove_all(dive_);
    render(8);
    fs::remove(image(lost % 2, lost));
    const Outcome outcome = replay();
    EXPECT_EQ(outcome.exit_code, 3) << lost << outcome.text;
    EXPECT_TRUE(holds(outcome.text, "finished, but 1 pair of the recording is missing, the first at " +
                                        std::to_string(time_ns(lost)) + " ns"))
        << outcome.text;
    EXPECT_TRUE(holds(outcome.text, "7 stepped, 1 missing")) << outcome.text;
  }
}

TEST_F(IncompleteRun, EverySecondRightImageMissing) {
  render(8);
  for (const int lost : {1, 3, 5, 7}) fs::remove(image(1, lost));
  const Outcome outcome = replay();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "finished, but 4 pairs of the recording are missing, the first at " +
                                      std::to_string(time_ns(1)) + " ns"))
      << outcome.text;
}

TEST_F(IncompleteRun, FiveMissingInARowAreWarnedOfAndMakeTheCodeThree) {
  render(10);
  for (int lost = 3; lost < 8; ++lost) fs::remove(image(0, lost));
  const Outcome outcome = replay();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "finished, but 5 pairs of the recording are missing")) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "warning: 5 pairs in a row are lost")) << outcome.text;
}

TEST_F(IncompleteRun, AFrameLimitBeforeTheLossIsAWholeRun) {
  render(8);
  fs::remove(image(1, 6));
  EXPECT_EQ(replay(" --frames 4").exit_code, 0);
  EXPECT_EQ(replay(" --frames 7").exit_code, 3);
}

TEST_F(IncompleteRun, AblateTellsOfMissingAndDamagedPairsInItsCode) {
  render(5);
  const std::string arguments = "ablate " + dive_.string() + " --only net_filter";
  EXPECT_EQ(tool(arguments).exit_code, 0);
  fs::remove(image(0, 2));
  const Outcome missing = tool(arguments);
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_TRUE(holds(missing.text, "finished, but 1 pair of the recording is missing")) << missing.text;
  spoil(0, 0);
  const Outcome both = tool(arguments);
  EXPECT_EQ(both.exit_code, 3);
  EXPECT_TRUE(
      holds(both.text, "finished, but 1 pair of the recording could not be read, and 1 pair of the recording is"))
      << both.text;
}

TEST_F(IncompleteRun, ADamagedFirstImageIsSkippedAndTheCodeIsThree) {
  render(4);
  spoil(1, 0);
  const Outcome outcome = replay();
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(holds(outcome.text, "pair skipped: " + image(1, 0).string())) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "3 stepped, 0 missing")) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "finished, but 1 pair of the recording could not be read\n")) << outcome.text;
}

TEST_F(IncompleteRun, DamagedPairsAtTheStartAreSkippedHoweverMany) {
  render(8);
  for (int frame = 0; frame < 5; ++frame) spoil(frame % 2, frame);
  const Outcome outcome = replay();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "3 stepped, 0 missing in the recording, 5 unreadable, 0 dropped")) << outcome.text;
  EXPECT_FALSE(fs::exists(out_ / "INCOMPLETE"));
}

// Damaged in the middle and at the end, missing at the start and at the end: not all of them leave a gap between
// frames.
TEST_F(IncompleteRun, EvalTellsTheNumbersThatReplayTold) {
  render(12);
  fs::remove(image(0, 0));
  for (const int frame : {4, 5, 9}) spoil(1, frame);
  fs::remove(image(0, 11));
  fs::remove(image(1, 11));
  const std::string numbers = "7 stepped, 2 missing in the recording, 3 unreadable, 0 dropped";
  const Outcome replayed = replay();
  EXPECT_EQ(replayed.exit_code, 3);
  EXPECT_TRUE(holds(replayed.text, numbers)) << replayed.text;
  const std::string run = dive_.string() + " " + out_.string();
  const Outcome table = tool("eval " + run);
  EXPECT_TRUE(holds(table.text, numbers)) << table.text;
  const Outcome json = tool("eval --json " + run);
  EXPECT_TRUE(holds(json.text, "\"frames_missing\":2,\"frames_unreadable\":3,\"frames_dropped\":0")) << json.text;
  fs::remove(out_ / "lost_pairs.csv");
  EXPECT_TRUE(holds(tool("eval " + run).text, "7 stepped, 3 in gaps")) << "as of a run that was killed";
  write_text(out_ / "lost_pairs.csv", "missing,unreadable,dropped\n1,x,0\n");
  const Outcome damaged = tool("eval " + run);
  EXPECT_EQ(damaged.exit_code, 3);
  EXPECT_TRUE(holds(damaged.text, "lost_pairs.csv:2")) << damaged.text;
}

TEST_F(IncompleteRun, ARecordingThatBreaksOffHasACodeOfItsOwn) {
  render(10);
  for (int frame = 4; frame < 10; ++frame) spoil(0, frame);
  const Outcome outcome = replay();
  EXPECT_EQ(outcome.exit_code, 8) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "the recording broke off")) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "4 stepped, 0 missing in the recording, 4 unreadable")) << outcome.text;
  expect_told("the recording broke off: ");
  EXPECT_EQ(tool("ablate " + dive_.string() + " --only net_filter").exit_code, 8);
}

// A limit on the size of files stands for a disk that fills up: the same calls fail.
TEST_F(IncompleteRun, AFullDiskLeavesTheMarkAndTheReason) {
  render(30);
  const Outcome outcome = replay("", "trap '' XFSZ; ulimit -f 16; ");
  EXPECT_EQ(outcome.exit_code, 6) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "cannot write")) << outcome.text;
  EXPECT_TRUE(holds(read_text(out_ / "INCOMPLETE"), "cannot write: File too large")) << read_text(out_ / "INCOMPLETE");
  EXPECT_EQ(replay().exit_code, 0) << "done anew, the mark goes";
  EXPECT_FALSE(fs::exists(out_ / "INCOMPLETE"));
}

TEST_F(IncompleteRun, NothingIsBegunWhereNothingCanBeWritten) {
  render(3);
  const Outcome outcome = replay("", "trap '' XFSZ; ulimit -f 0; ");
  EXPECT_EQ(outcome.exit_code, 6) << outcome.text;
  EXPECT_TRUE(fs::is_empty(out_));
}

TEST_F(IncompleteRun, AKilledRunKeepsItsMark) {
  render(30);
  const std::string command = "bash -c 'set -m; " + std::string(PELORUS_TOOL) + " replay " + dive_.string() +
                              " --realtime --out " + out_.string() + " >/dev/null 2>&1 & p=$!; while [ $(cat " +
                              out_.string() +
                              "/frames.csv 2>/dev/null | wc -l) -lt 4 ]; do kill -0 $p || exit 99; sleep 0.05; done; "
                              "kill -KILL $p; wait $p' 2>/dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 137);
  expect_told("it is under way or was killed");
}

TEST_F(IncompleteRun, InterruptedReplayEndsWithValidFilesAndCode130) {
  const std::string scene = small_scene(folder_, 100000);
  // The shell waits until frames flow, then interrupts.
  const std::string command = std::string(PELORUS_TOOL) + " replay " + scene + " --out " + out_.string() +
                              " >/dev/null 2>&1 & p=$!; while [ $(cat " + out_.string() +
                              "/frames.csv 2>/dev/null | wc -l) -lt 3 ]; do kill -0 $p || exit 99; sleep 0.05; done; "
                              "kill -INT $p; wait $p";
  const int status = std::system(("bash -c 'set -m; " + command + "' 2>/dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_EQ(read_text(out_ / "frames.csv").back(), '\n');
  EXPECT_EQ(read_text(out_ / "INCOMPLETE"), "interrupted\n");
}

}  // namespace
}  // namespace pelorus
