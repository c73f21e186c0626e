// Commands over VIS_COMMAND to the service as a process of its own: each is answered, and does what it says.
#include <gtest/gtest.h>

#include <algorithm>
#include <bot_core/image_t.hpp>
#include <opencv2/imgcodecs.hpp>
#include <pelorus/vis_command_ack_t.hpp>
#include <pelorus/vis_command_t.hpp>

#include "drivers/replay/dataset.h"
#include "tests/firmware-host/pelorusd/running_service.h"

namespace pelorus {
namespace {

using test::TemporaryFolder;

class Commands : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::lcm_available()) GTEST_SKIP() << "no multicast route: ip route add 224.0.0.0/4 dev lo";
  }
};

// The operator's end of VIS_COMMAND.
class Operator {
 public:
  explicit Operator(const std::string& url) : acks_(url, "TEST.VIS_COMMAND_ACK"), sender_(url) {}

  // Whether the service accepted. Once it has answered at all, a command is sent once only.
  bool ask(const std::string& text) {
    vis_command_t command{};
    command.id = ++id_;
    command.command = text;
    const auto answered = [this] { return !acks_.messages.empty() && acks_.messages.back().id == id_; };
    for (int i = 0; i < 50 && !answered(); ++i) {
      if (i == 0 || acks_.messages.empty()) sender_.publish("TEST.VIS_COMMAND", &command);
      acks_.wait(answered, 0.2);
    }
    return answered() && acks_.messages.back().accepted;
  }
  [[nodiscard]] std::int64_t answered_utime() const { return acks_.messages.back().utime; }

 private:
  test::Listener<vis_command_ack_t> acks_;
  lcm::LCM sender_;
  int id_ = 0;
};

TEST_F(Commands, CommandsAreAnsweredAndObeyed) {
  test::RunningService service(test::rendered_dive(), test::kForever, 6);
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  Operator pilot(service.url());
  const auto ask = [&](const std::string& text) { return pilot.ask(text); };
  EXPECT_TRUE(ask("standby"));
  EXPECT_TRUE(service.wait_for_state("STANDBY")) << service.log();
  EXPECT_TRUE(ask("resume"));
  EXPECT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  EXPECT_TRUE(ask("reset"));
  EXPECT_TRUE(service.wait_for_state("INIT")) << service.log();
  EXPECT_FALSE(ask("self-destruct"));
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait(), 0);
}

// What is recorded is what was seen, from the start command on and not after the stop.
TEST_F(Commands, ARecordingHoldsThePairsBetweenStartAndStop) {
  const TemporaryFolder folder;
  test::RunningService service(
      test::rendered_dive(),
      test::kForever + "recorder:\n  min_free_gb: 0\n  folder: \"" + folder.path().string() + "\"\n", 10);
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  Operator pilot(service.url());
  EXPECT_FALSE(pilot.ask("record_stop")) << "nothing to be stopped";
  const std::size_t before = service.odom.messages.size();
  ASSERT_TRUE(pilot.ask("record_start"));
  EXPECT_FALSE(pilot.ask("record_start")) << "recording already";
  ASSERT_TRUE(service.odom.wait_for(service.odom.messages.size() + 12)) << service.log();
  ASSERT_TRUE(pilot.ask("record_stop"));
  const std::int64_t stopped_utime = pilot.answered_utime();
  ASSERT_TRUE(service.odom.wait_for(service.odom.messages.size() + 15)) << service.log();
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait(), 0);
  service.odom.wait([] { return false; }, 0.2);

  std::vector<std::filesystem::path> recordings;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) recordings.push_back(entry.path());
  ASSERT_EQ(recordings.size(), 1U);
  auto recorded = open_dataset(recordings[0]);
  auto shown = open_dataset(test::rendered_dive());
  ASSERT_TRUE(recorded.ok()) << recorded.error().message();
  ASSERT_TRUE(shown.ok()) << shown.error().message();
  EXPECT_GE(recorded.value()->pair_count(), 10U);
  EXPECT_LE(recorded.value()->pair_count(), service.odom.messages.size() - before);
  std::vector<SourcePair> film(static_cast<std::size_t>(test::kDiveFrames));
  for (SourcePair& pair : film) ASSERT_TRUE(shown.value()->next(pair).value());
  const auto& live = service.odom.messages;
  SourcePair pair;
  for (std::size_t i = 0; recorded.value()->next(pair).value(); ++i) {
    const std::int64_t utime = pair.capture_time.ns / 1000;
    EXPECT_LT(utime, stopped_utime + 700'000) << "long after the stop";
    const auto result = std::find_if(live.begin(), live.end(), [&](const auto& m) { return m.utime == utime; });
    ASSERT_NE(result, live.end()) << "pair " << i << " has the time of no result";
    // Played again and again: the number of the pair says which one it was.
    const SourcePair& truth = film[static_cast<std::size_t>(result->seq - 1) % film.size()];
    for (int v = 0; v < pair.left.height(); v += 7) {
      ASSERT_TRUE(std::equal(pair.left.row(v), pair.left.row(v) + pair.left.width(), truth.left.row(v)));
      ASSERT_TRUE(std::equal(pair.right.row(v), pair.right.row(v) + pair.right.width(), truth.right.row(v)));
    }
  }
}

TEST_F(Commands, ASnapshotIsAPictureWhereNoneIsDue) {
  test::RunningService service(test::rendered_dive(), test::kForever, 16, "  preview_rate_hz: 0\n");
  test::Listener<bot_core::image_t> images(service.url(), "TEST.VIS_IMAGE_LEFT");
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  EXPECT_FALSE(images.wait_for(1, 0.5)) << "none was asked for";
  Operator pilot(service.url());
  ASSERT_TRUE(pilot.ask("snapshot"));
  ASSERT_TRUE(images.wait_for(1)) << service.log();
  EXPECT_FALSE(images.wait_for(2, 0.5)) << "one for one command";
  const bot_core::image_t& image = images.messages[0];
  ASSERT_EQ(image.data.size(), static_cast<std::size_t>(image.size));
  const cv::Mat picture = cv::imdecode(image.data, cv::IMREAD_COLOR);
  EXPECT_EQ(picture.cols, image.width);
  EXPECT_EQ(picture.rows, image.height);
  EXPECT_GT(image.width, 0);
  service.odom.wait([] { return false; }, 0.1);
  const auto& live = service.odom.messages;
  EXPECT_TRUE(std::any_of(live.begin(), live.end(), [&](const vis_odom_t& m) { return m.utime == image.utime; }));
}

}  // namespace
}  // namespace pelorus
