// `pelorus command` as a process of its own, on the bus of a real service.
#include <gtest/gtest.h>

#include <bot_core/image_t.hpp>
#include <pelorus/vis_command_ack_t.hpp>

#include "tests/firmware-host/pelorusd/running_service.h"

namespace pelorus::test {
namespace {

struct Said {
  int exit_code = 0;
  std::string text;
};

Said command(const std::string& url, const std::vector<std::string>& words) {
  const TemporaryFolder folder;
  std::vector<std::string> line{PELORUS_TOOL, "command", "--url", url, "--vehicle", "TEST"};
  line.insert(line.end(), words.begin(), words.end());
  ChildProcess tool(line, folder.path() / "said");
  const int exit_code = tool.wait_at_most(60);
  return {exit_code, read_text(folder.path() / "said")};
}

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

class ServiceCommand : public testing::Test {
 protected:
  void SetUp() override {
    if (!lcm_available()) GTEST_SKIP() << "no multicast route";
  }
};

TEST_F(ServiceCommand, ReachesARunningServiceAndTellsItsAnswer) {
  const TemporaryFolder folder;
  const std::filesystem::path recordings = folder.path() / "recordings";
  RunningService service(rendered_dive(),
                         "  preview_rate_hz: 0\nrecorder: {folder: \"" + recordings.string() + "\"}\n# repeat\n", 31);
  Listener<bot_core::image_t> pictures(service.url(), "TEST.VIS_IMAGE_LEFT");
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();

  Said said = command(service.url(), {"standby"});
  EXPECT_EQ(said.exit_code, 0) << said.text;
  EXPECT_TRUE(says(said.text, "standby: resting")) << said.text;
  EXPECT_TRUE(service.wait_for_state("STANDBY", "commanded"));
  EXPECT_EQ(command(service.url(), {"resume"}).exit_code, 0);
  EXPECT_TRUE(service.wait_for_state("TRACKING"));

  const int before = service.odom.messages.back().reset_counter;
  EXPECT_EQ(command(service.url(), {"reset"}).exit_code, 0);
  EXPECT_TRUE(service.odom.wait([&] { return service.odom.messages.back().reset_counter > before; }));

  EXPECT_FALSE(pictures.wait_for(1, 0.5)) << "none without being asked";
  EXPECT_EQ(command(service.url(), {"snapshot"}).exit_code, 0);
  EXPECT_TRUE(pictures.wait_for(1));

  EXPECT_EQ(command(service.url(), {"record_start"}).exit_code, 0);
  said = command(service.url(), {"record_start"});
  EXPECT_EQ(said.exit_code, 1) << "refused";
  EXPECT_TRUE(says(said.text, "the service refuses 'record_start': recording already")) << said.text;
  EXPECT_EQ(command(service.url(), {"record_stop"}).exit_code, 0);
  EXPECT_EQ(command(service.url(), {"record_stop"}).exit_code, 1);
  EXPECT_FALSE(std::filesystem::is_empty(recordings));
}

TEST_F(ServiceCommand, WithoutAnAnswerItEndsInTimeAndSaysWhatToDo) {
  const auto start = std::chrono::steady_clock::now();
  const Said said = command(loopback_url(32), {"reset", "--timeout", "0.3"});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_GE(took.count(), 0.3);
  EXPECT_LT(took.count(), 4.5) << "less than without --timeout";
  EXPECT_TRUE(says(said.text, "no answer within 0.3 s to 'reset' on TEST.VIS_COMMAND")) << said.text;
  EXPECT_TRUE(says(said.text, "is pelorusd running")) << said.text;
}

// Another one's answer, also to the same command, is not ours.
TEST_F(ServiceCommand, OnlyTheAnswerToItsOwnCommandCounts) {
  const TemporaryFolder folder;
  const std::string url = loopback_url(33);
  lcm::LCM bus(url);
  ChildProcess tool({PELORUS_TOOL, "command", "reset", "--url", url, "--vehicle", "TEST", "--timeout", "2"},
                    folder.path() / "said");
  int code = -2;
  while ((code = tool.wait_at_most(0.05)) == -2) {
    vis_command_ack_t ack{};
    ack.id = -1;  // the tool's are not negative
    ack.command = "reset";
    ack.accepted = true;
    bus.publish("TEST.VIS_COMMAND_ACK", &ack);
  }
  EXPECT_EQ(code, 1) << read_text(folder.path() / "said");
}

TEST_F(ServiceCommand, WrongUsageAndABusThatCannotBeOpened) {
  const Said unknown = command(loopback_url(34), {"restart"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_TRUE(says(unknown.text, "record_stop")) << "names the commands\n" << unknown.text;
  EXPECT_EQ(command("nonsense://", {"reset"}).exit_code, 6);
  const Said help = command(loopback_url(34), {"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_TRUE(says(help.text, "Exit codes")) << help.text;
}

}  // namespace
}  // namespace pelorus::test
