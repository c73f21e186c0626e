#include "services/command_listener.h"

#include <gtest/gtest.h>

#include <atomic>
#include <pelorus/vis_command_ack_t.hpp>
#include <pelorus/vis_command_t.hpp>

#include "tests/services/lcm_loopback.h"

namespace pelorus {
namespace {

TEST(CommandListener, AnswersEachCommandWithItsId) {
  if (!test::lcm_available()) GTEST_SKIP() << "no multicast route: ip route add 224.0.0.0/4 dev lo";
  LcmConfig config;
  config.url = test::loopback_url(2);
  config.vehicle = "TEST";
  test::Listener<vis_command_ack_t> answers(config.url, "TEST.VIS_COMMAND_ACK");
  std::atomic<int> asked{0};
  const auto answer = [&](const std::string& command, const std::string&) {
    ++asked;
    return CommandAnswer{command == "reset", command == "reset" ? "started anew" : "unknown command"};
  };
  const CommandListener listener(config, answer, [] { return Timestamp{1'600'000'000'123'456'789}; });
  lcm::LCM sender(config.url);
  vis_command_t command{};
  // The listener subscribes in its own time: asked again until it answers.
  for (int i = 0; i < 100 && answers.messages.empty(); ++i) {
    command.id = 41;
    command.command = "reset";
    sender.publish("TEST.VIS_COMMAND", &command);
    answers.wait_for(1, 0.1);
  }
  ASSERT_FALSE(answers.messages.empty());
  EXPECT_EQ(answers.messages[0].id, 41);
  EXPECT_TRUE(answers.messages[0].accepted);
  EXPECT_EQ(answers.messages[0].command, "reset");
  EXPECT_EQ(answers.messages[0].utime, 1'600'000'000'123'456) << "of the clock it was given, as all messages";
  const std::size_t before = answers.messages.size();
  command.id = 42;
  command.command = "dance";
  sender.publish("TEST.VIS_COMMAND", &command);
  ASSERT_TRUE(answers.wait([&] { return !answers.messages.empty() && answers.messages.back().id == 42; }));
  EXPECT_FALSE(answers.messages.back().accepted);
  EXPECT_EQ(answers.messages.back().text, "unknown command");
  EXPECT_GT(answers.messages.size(), before);
}

}  // namespace
}  // namespace pelorus
