// What the tool says of a command line that is wrong, and that help knows better.
#include <gtest/gtest.h>

#include <vector>

#include "tests/firmware-host/pelorus/tool_process.h"

namespace pelorus {
namespace {

using test::Outcome;
using test::run_tool;

TEST(Usage, EveryVerbExplainsItself) {
  std::vector<std::string> verbs{"replay", "eval", "report", "ablate", "demo", "doctor", "export", "synth"};
  for (const char* verb : {"can dump", "can dbc", "can export", "calib check", "calib convert", "bench latency"}) {
    verbs.emplace_back(verb);
  }
  if (run_tool("--help").text.find("\n  top ") != std::string::npos) {  // built with LCM
    verbs.emplace_back("top");
    verbs.emplace_back("command");
  }
  for (const std::string& verb : verbs) {
    const Outcome outcome = run_tool(verb + " --help");
    EXPECT_EQ(outcome.exit_code, 0) << verb;
    EXPECT_NE(outcome.text.find("Exit codes"), std::string::npos) << verb;
  }
}

TEST(Usage, WrongUsageEndsWithTheDocumentedCode) {
  for (const char* arguments : {"", "replay", "replay a --out b --bogus", "bogus"}) {
    EXPECT_EQ(run_tool(arguments).exit_code, 2) << arguments;
  }
}

TEST(Usage, WrongUsageNamesTheWordAndTheHelpThatKnowsBetter) {
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

TEST(Usage, HelpNamesEverySourceAndExitCode) {
  EXPECT_NE(run_tool("replay --help").text.find("LCM log"), std::string::npos);
  EXPECT_NE(run_tool("demo --help").text.find("3 bad input, 4 calibration"), std::string::npos);
  const std::string synth = run_tool("synth --help").text;
  EXPECT_NE(synth.find("--overwrite"), std::string::npos) << synth;
  EXPECT_EQ(synth.find("--force"), std::string::npos) << synth;
}

TEST(Usage, NumbersOutOfRangeAreToldInWords) {
  const Outcome outcome = run_tool("synth static --frames 0 --out out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("'0' is not a number above 0"), std::string::npos) << outcome.text;
  const Outcome body = run_tool("export run --format tum --body -1");
  EXPECT_EQ(body.exit_code, 2);
  EXPECT_NE(body.text.find("--body: '-1' is not a number above 0 ("), std::string::npos) << body.text;
}

TEST(Usage, AblateNamesTheStepsWhenAStepIsUnknown) {
  const Outcome outcome = run_tool("ablate paper --only net_filer");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("net_filter"), std::string::npos) << outcome.text;
}

// None of them is taken for another number, or for none at all.
TEST(Usage, CountsAndSeedsThatAreNoneAreRefusedByEveryVerb) {
  const test::TemporaryFolder folder;
  const std::string there = "cd " + folder.path().string() + " && ";
  const std::string huge = "99999999999999999999";
  for (const std::string count : {"0", "-1", "1.5", "3x", "2147483648"}) {
    for (const std::string verb :
         {"replay a --out b --frames ", "demo --out b --frames ", "ablate a --frames ", "synth paper --out b --frames ",
          "export a --format tum --body ", "can dump a --count ", "replay a --out b --overlay-every "}) {
      const Outcome outcome = run_tool(verb + count, there);
      EXPECT_EQ(outcome.exit_code, 2) << verb << count << outcome.text;
      EXPECT_NE(outcome.text.find("'" + count + "' is not a "), std::string::npos) << verb << outcome.text;
    }
  }
  for (const std::string& number : {std::string("-1"), huge, std::string("7.5")}) {
    for (const std::string verb : {"synth paper --out b --seed ", "calib check a --pair "}) {
      const Outcome outcome = run_tool(verb + number, there);
      EXPECT_EQ(outcome.exit_code, 2) << verb << number << outcome.text;
      EXPECT_NE(outcome.text.find("'" + number + "' is not a whole number from 0"), std::string::npos) << outcome.text;
    }
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Usage, ABodyAloneIsForTheFormatsThatCanHoldOne) {
  const Outcome outcome = run_tool("export run --format csv --body 1");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("tum, kitti and ply"), std::string::npos) << outcome.text;
}

TEST(Usage, AnAddressThatIsNoneOfLcmIsNamedWithTheCure) {
  if (run_tool("--help").text.find("\n  top ") == std::string::npos) GTEST_SKIP() << "built without LCM";
  for (const std::string url :
       {"nonsense", "udp://239.255.76.67:7667", "udpm://192.168.0.1:7667", "udpm://239.255.76.67:0"}) {
    for (const std::string verb : {"top --once --timeout 1 --url ", "command reset --timeout 1 --url "}) {
      const Outcome outcome = run_tool(verb + url);
      EXPECT_EQ(outcome.exit_code, 6) << outcome.text;
      EXPECT_EQ(outcome.text, "pelorus: --url: '" + url + "' is no address of LCM (write it like " +
                                  "udpm://239.255.76.67:7667?ttl=0)\n");
    }
  }
}

}  // namespace
}  // namespace pelorus
