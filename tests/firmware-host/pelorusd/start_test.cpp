// Starting pelorusd: messages and exit codes, and a computer without a multicast route.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "firmware-host/runtime/camera_config.h"
#include "tests/firmware-host/pelorusd/running_service.h"
#include "tests/support/private_network.h"

namespace pelorus {
namespace {

using test::TemporaryFolder;

struct Outcome {
  int exit_code = 0;
  std::string text;
};

Outcome start(const std::string& arguments) {
  Outcome outcome;
  std::FILE* pipe = popen((std::string(PELORUSD) + " " + arguments + " 2>&1").c_str(), "r");
  std::array<char, 512> part{};
  while (pipe && std::fgets(part.data(), part.size(), pipe)) outcome.text += part.data();
  const int status = pipe ? pclose(pipe) : -1;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

Outcome start_with(const std::string& settings, const std::string& option = "") {
  const TemporaryFolder folder;
  test::write_text(folder.path() / "p.yaml", settings);
  return start("--config " + (folder.path() / "p.yaml").string() + " " + option);
}

TEST(Start, EachKindOfFailureHasItsExitCodeAndSaysWhere) {
  EXPECT_EQ(start("").exit_code, 2);
  EXPECT_EQ(start("--config").exit_code, 2);
  const Outcome absent = start("--config /nonexistent/pelorus.yaml");
  EXPECT_EQ(absent.exit_code, 6);
  EXPECT_NE(absent.text.find("/nonexistent/pelorus.yaml"), std::string::npos);
  const Outcome no_source = start_with("source:\n  path: /nonexistent/dive\n");
  EXPECT_EQ(no_source.exit_code, 3);
  EXPECT_NE(no_source.text.find("/nonexistent/dive"), std::string::npos) << no_source.text;
  EXPECT_EQ(start_with("").exit_code, 5) << "no source is given";
  const Outcome no_calibration = start_with("source:\n  kind: aravis\n");
  EXPECT_EQ(no_calibration.exit_code, 5);
  EXPECT_NE(no_calibration.text.find("source.calibration"), std::string::npos) << no_calibration.text;
}

TEST(Start, AnUnknownWordIsNamed) {
  const char* const help = " (pelorusd --help tells what there is)\n";
  EXPECT_EQ(start("--nonsense").text, std::string("pelorusd: '--nonsense' is no option of pelorusd") + help);
  EXPECT_EQ(start("extra").text, std::string("pelorusd: 'extra' is not expected") + help);
  EXPECT_EQ(start("--confg x").text, std::string("pelorusd: '--confg' is no option of pelorusd") + help);
  EXPECT_EQ(start("--config a --confg x").text, std::string("pelorusd: '--confg' is no option of pelorusd") + help);
  EXPECT_EQ(start("").text, std::string("pelorusd: --config is required") + help);
}

TEST(Start, ACalibrationThatCannotBeUsedHasItsExitCode) {
  const TemporaryFolder folder;
  const std::string calibration = (folder.path() / "calibration.yaml").string();
  test::write_text(calibration, "x: 1\n");
  const Outcome outcome = start_with("source:\n  path: \"" + test::rendered_dive().string() + "\"\n  calibration: \"" +
                                     calibration + "\"\n");
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_NE(outcome.text.find("calibration.yaml"), std::string::npos) << outcome.text;
}

TEST(Start, HelpAndVersionOnAFullDiskAreNoSuccess) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  for (const std::string option : {"--help", "--version"}) {
    EXPECT_EQ(start(option).exit_code, 0) << option;
    EXPECT_EQ(start(option + " 2>/dev/null >/dev/full #").exit_code, 6) << option;
  }
}

TEST(Start, WhatHelpPromisesIsWhatTheProgramCanDo) {
  EXPECT_EQ(start("--help").text.find("7 device"), std::string::npos) << "absent devices do not end the service";
}

TEST(Start, ExchangedPicturesAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path dive = test::copied_dive(folder);
  const std::filesystem::path left = dive / "mav0/cam0/data", right = dive / "mav0/cam1/data", aside = dive / "aside";
  std::filesystem::rename(left, aside);
  std::filesystem::rename(right, left);
  std::filesystem::rename(aside, right);
  const Outcome outcome = start_with("source:\n  path: \"" + dive.string() + "\"\n");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.text.find("pictures are exchanged"), std::string::npos) << outcome.text;
}

TEST(Start, AllProblemsOfTheConfigurationAreListedWithTheirLines) {
  const Outcome outcome =
      start_with("source:\n  pth: x\ntiming:\n  latency: 3\nlcm:\n  vehicle: [1]\nxyz:\n", "--check-config");
  EXPECT_EQ(outcome.exit_code, 5);
  for (const char* part : {"4 problems", "p.yaml:2", "p.yaml:4", "latency_ms", "p.yaml:6", "p.yaml:7"}) {
    EXPECT_NE(outcome.text.find(part), std::string::npos) << part << "\n" << outcome.text;
  }
}

// A file for the vehicle, one for its bench: neither has to be whole.
TEST(Start, RulesBetweenSettingsHoldForAllFilesTogether) {
  if (missing_driver("v4l2")) GTEST_SKIP() << missing_driver("v4l2")->what;
  const TemporaryFolder folder;
  const std::string base = (folder.path() / "base.yaml").string(), boat = (folder.path() / "boat.yaml").string();
  test::write_text(base, "source:\n  kind: v4l2\n  calibration: c\ncamera:\n  rate_hz: 20\n  gain_db: 3\n");
  test::write_text(boat, "camera:\n  left: /dev/video0\n  gain_db: -1\n");
  const Outcome whole = start("--check-config --config " + base + " --config " + boat);
  EXPECT_EQ(whole.exit_code, 0) << whole.text;
  EXPECT_EQ(start("--check-config --config " + base).exit_code, 5);
  test::write_text(boat, "camera:\n  left: /dev/video0\n  right: /dev/video0\n  tolerance_ms: 30\n  gain: 1\n");
  const Outcome broken = start("--check-config --config " + base + " --config " + boat);
  EXPECT_EQ(broken.exit_code, 5);
  for (const std::string& part : {std::string("4 problems"), base + ":6: camera.gain_db cannot be set",
                                  boat + ":3: camera.right is the left camera again",
                                  boat + ":4: camera.tolerance_ms must be below", boat + ":5: unknown key"}) {
    EXPECT_NE(broken.text.find(part), std::string::npos) << part << "\n" << broken.text;
  }
}

TEST(Start, CheckConfigEndsWithoutStarting) {
  const Outcome good = start_with("source:\n  path: /nonexistent\n", "--check-config");
  EXPECT_EQ(good.exit_code, 0);
  EXPECT_NE(good.text.find("source.path='/nonexistent'"), std::string::npos) << good.text;
}

TEST(Start, AMountingThatWouldNotBeUsedIsAnError) {
  const std::string mounting = "source:\n  path: /nonexistent\nmounting:\n  pitch_deg: -90\n";
  const Outcome refused = start_with(mounting, "--check-config");
  EXPECT_EQ(refused.exit_code, 5);
  EXPECT_NE(refused.text.find("p.yaml:4"), std::string::npos) << refused.text;
  EXPECT_NE(refused.text.find("mounting.given"), std::string::npos) << refused.text;
  EXPECT_EQ(start_with(mounting + "  given: true\n", "--check-config").exit_code, 0);
}

// In a child, because a process cannot leave a namespace it entered. Exit code 0: all went as it should.
int without_route(const std::filesystem::path& dive) {
  if (!test::enter_private_network({})) return 77;
  const TemporaryFolder folder;
  const std::string url = test::loopback_url(9);
  test::write_text(folder.path() / "p.yaml", "source:\n  path: \"" + dive.string() +
                                                 "\"\n  repeat: true\nlcm:\n  url: \"" + url + "\"\n  vehicle: TEST\n");
  test::ChildProcess service({PELORUSD, "--config", (folder.path() / "p.yaml").string()}, folder.path() / "log");
  const auto log = [&] { return test::read_text(folder.path() / "log"); };
  const auto says = [&](const char* text, std::size_t from = 0) {
    for (int i = 0; i < 100 && log().find(text, from) == std::string::npos; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return log().find(text, from) != std::string::npos;
  };
  if (!says("LCM cannot be reached")) return 1;
  if (!says("TRACKING")) return 2;  // vision goes on meanwhile
  if (!test::add_multicast_route()) return 3;
  test::Listener<vis_odom_t> odom(url, "TEST.VIS_ODOM");
  test::Listener<vis_health_t> health(url, "TEST.VIS_HEALTH");
  if (!odom.wait_for(3, 10)) return 4;
  if (!health.wait_for(1, 10) || health.messages[0].lcm_errors == 0) return 5;
  // Told as soon as it is open again, not with the next second.
  if (health.messages[0].utime - odom.messages[0].publish_utime > 300'000) return 7;
  // Lost under way: told, each message counted, and it speaks again by itself.
  const std::size_t told_so_far = log().size();
  const std::int64_t errors_so_far = health.messages.back().lcm_errors;
  if (!test::delete_multicast_route()) return 8;
  if (!says("LCM cannot be reached", told_so_far)) return 9;
  (void)odom.wait([] { return false; }, 0.2);  // what was under way
  const std::int64_t last_heard = odom.messages.back().seq;
  if (log().find("requires a valid multicast route") != std::string::npos)
    return 10;  // ten lines of LCM's own, once a second
  if (!test::add_multicast_route()) return 11;
  const std::size_t heard = odom.messages.size(), reported = health.messages.size();
  if (!odom.wait_for(heard + 3, 10) || !health.wait_for(reported + 2, 10)) return 12;
  const std::int64_t unheard = odom.messages[heard].seq - last_heard - 1;
  const std::int64_t counted = health.messages.back().lcm_errors - errors_so_far;
  // Two or three messages a result, and some reports and pictures.
  if (unheard < 1 || counted < 2 * unheard || counted > 3 * unheard + 20) return 13;
  if (health.messages.back().lcm_reconnects != 0) return 14;
  service.send(SIGTERM);
  return service.wait() == 0 ? 0 : 6;
}

TEST(Start, WithoutAMulticastRouteItWorksOnAndSpeaksAsSoonAsThereIsOne) {
  const std::filesystem::path dive = test::rendered_dive();
  const pid_t child = ::fork();
  if (child == 0) ::_exit(without_route(dive));
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "network namespaces are not allowed here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace pelorus
