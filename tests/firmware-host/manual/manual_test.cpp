// Manual pages and completion against the tool's own command line, and against a parser with everything that is hard
// to write in roff.

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <string>

#include "firmware-host/manual/bash_completion.h"
#include "firmware-host/manual/man_page.h"
#include "firmware-host/pelorus/verbs.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

const ManualFacts kFacts{"pelorus", "1", "1.2.3", "\\fBpelorusd\\fR(8)"};

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string in_roff(std::string text) {
  for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at + 2)) text.insert(at, "\\");
  return text;
}

void expect_options(const CLI::App& parser, const ManPage& page) {
  for (const CLI::Option* option : parser.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) {
      EXPECT_TRUE(holds(page.text, in_roff("--" + name))) << page.file_name << " lacks --" << name;
    }
  }
  for (const CLI::App* verb : parser.get_subcommands([](const CLI::App*) { return true; })) expect_options(*verb, page);
}

TEST(ManPages, HaveEveryVerbAndOptionOfTheTool) {
  CLI::App app;
  const auto verbs = add_verbs(app);
  std::map<std::string, ManPage> pages;
  for (const ManPage& page : man_pages(app, kFacts)) pages[page.file_name] = page;
  ASSERT_EQ(pages.size(), verbs.size() + 1);
  for (const Verb& verb : verbs) {
    const std::string name = verb.parser->get_name();
    ASSERT_TRUE(pages.count("pelorus-" + name + ".1")) << name;
    expect_options(*verb.parser, pages["pelorus-" + name + ".1"]);
    EXPECT_TRUE(holds(pages["pelorus.1"].text, "\\fBpelorus\\-" + name + "\\fR(1)")) << name;
    EXPECT_TRUE(holds(pages["pelorus-" + name + ".1"].text, in_roff(verb.parser->get_description()))) << name;
  }
}

TEST(ManPages, TextCannotBecomeAMacro) {
  CLI::App app{"Pelorus: what it does."};
  std::string value;
  app.add_option("--path", value, ".hidden files and a back\\slash");
  app.add_option("--secret", value, "not to be shown")->group("");
  app.footer("First line.\n'quoted' second line.\nExit codes: 0 good, 1 bad.");
  const std::string page = man_pages(app, kFacts).at(0).text;
  EXPECT_TRUE(holds(page, "pelorus \\- what it does\n"));
  EXPECT_TRUE(holds(page, "\n\\&.hidden files and a back\\eslash\n"));
  EXPECT_TRUE(holds(page, "\n\\&'quoted' second line.\n"));
  EXPECT_TRUE(holds(page, ".SH EXIT STATUS\n0 good, 1 bad.\n"));
  EXPECT_FALSE(holds(page, "not to be shown"));
}

// What bash offers for `words`, the last of them unfinished.
std::string completed(const std::string& words, int last) {
  CLI::App app;
  const auto verbs = add_verbs(app);
  const test::TemporaryFolder folder;
  const auto script = folder.path() / "pelorus";
  test::write_text(script, bash_completion(app, "pelorus"));
  const std::string command = "bash -c '. " + script.string() + "; compopt() { echo NOFILES; }; COMP_WORDS=(" + words +
                              ") COMP_CWORD=" + std::to_string(last) + "; _pelorus; echo ${COMPREPLY[@]}' 2>&1";
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string said;
  std::array<char, 256> part{};
  while (std::fgets(part.data(), part.size(), pipe) != nullptr) said += part.data();
  ::pclose(pipe);
  if (!said.empty()) said.pop_back();
  return said;
}

TEST(BashCompletion, OffersVerbsOptionsAndChoices) {
  EXPECT_EQ(completed("pelorus re", 1), "replay report");
  EXPECT_EQ(completed("pelorus calib \"\"", 2), "check convert");
  EXPECT_EQ(completed("pelorus calib convert --to k", 4), "kalibr");
  EXPECT_EQ(completed("pelorus replay data --overl", 3), "--overlay --overlay-every");
  EXPECT_EQ(completed("pelorus calib check --out", 3), "--out");
}

TEST(BashCompletion, LeavesFilesToTheShellAndOffersNoneForNumbers) {
  EXPECT_EQ(completed("pelorus replay \"\"", 2), "");
  EXPECT_EQ(completed("pelorus replay --config \"\"", 3), "");
  EXPECT_EQ(completed("pelorus replay --frames \"\"", 3), "NOFILES\n");
}

}  // namespace
}  // namespace pelorus
