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

}  // namespace
}  // namespace pelorus
