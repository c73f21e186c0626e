// What the service manager hears of pelorusd: ready, stopping, and the watchdog's food, which ends when a single thread
// hangs while all others live.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <chrono>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

#include "tests/firmware-host/pelorusd/running_service.h"
#include "tests/support/held_thread.h"

namespace pelorus {
namespace {

using namespace std::chrono_literals;

// The socket of the service manager, named in the environment of children that are started meanwhile.
class NotifySocket {
 public:
  NotifySocket() : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const timeval patience{10, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    const std::string name = (folder_.path() / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (name.size() >= sizeof address.sun_path) {
      ADD_FAILURE() << name << " is too long for a socket: set TMPDIR to a shorter folder";
      return;
    }
    std::memcpy(address.sun_path, name.data(), name.size());
    EXPECT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
    ::setenv("WATCHDOG_USEC", "1000000", 1);
  }
  ~NotifySocket() {
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
    ::close(fd_);
  }
  // Until `times` messages held `wanted`; false after ten seconds without any message.
  bool hear(const std::string& wanted, int times = 1) {
    std::array<char, 512> text{};
    for (int count = 0; count < times;) {
      const ssize_t length = ::recv(fd_, text.data(), text.size(), 0);
      if (length <= 0) return false;
      const std::string part(text.data(), static_cast<std::size_t>(length));
      heard += part + "\n";
      count += part.find(wanted) != std::string::npos ? 1 : 0;
    }
    return true;
  }
  // Meals of the watchdog in that time, and what else is said.
  int meals_within(std::chrono::milliseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    int meals = 0;
    std::array<char, 512> text{};
    while (std::chrono::steady_clock::now() < end) {
      const ssize_t length = ::recv(fd_, text.data(), text.size(), MSG_DONTWAIT);
      if (length <= 0) {
        std::this_thread::sleep_for(10ms);
        continue;
      }
      meals += std::string(text.data(), static_cast<std::size_t>(length)) == "WATCHDOG=1" ? 1 : 0;
    }
    return meals;
  }

  std::string heard;

 private:
  test::TemporaryFolder folder_;
  int fd_;
};

class Watchdog : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::lcm_available()) GTEST_SKIP() << "no multicast route: ip route add 224.0.0.0/4 dev lo";
  }
  // Skips where nobody may hold a thread; one that is not there is a failure.
  void hold(const test::RunningService& service, const std::string& name) {
    const pid_t thread = test::thread_named(service.process->id(), name);
    ASSERT_GT(thread, 0) << "no thread " << name;
    hung_.emplace(thread);
    if (hung_->refused()) GTEST_SKIP() << "no right to hold the thread " << name << " (ptrace)";
    ASSERT_TRUE(hung_->held()) << name;
  }
  NotifySocket manager_;
  std::optional<test::HeldThread> hung_;
};

TEST_F(Watchdog, IsFedFromReadyToStopping) {
  test::RunningService service(test::rendered_dive(), "# repeat\n", 8);
  EXPECT_TRUE(manager_.hear("READY=1")) << manager_.heard;
  EXPECT_TRUE(manager_.hear("WATCHDOG=1", 5)) << manager_.heard;
  EXPECT_TRUE(manager_.hear("STATUS=TRACKING")) << manager_.heard;
  service.process->send(SIGTERM);
  EXPECT_TRUE(manager_.hear("STOPPING=1")) << manager_.heard;
  EXPECT_EQ(service.process->wait(), 0);
}

struct Hang {
  const char* thread;
  const char* told;  // of the helpers that vision waits for, "": either of the two
};

class WatchdogOfAThread : public Watchdog, public ::testing::WithParamInterface<Hang> {};

TEST_P(WatchdogOfAThread, IsNotFedWhileItHangsAndIsFedAgainAfter) {
  test::RunningService service(test::rendered_dive(), test::kForever, 9);
  ASSERT_TRUE(manager_.hear("STATUS=TRACKING")) << manager_.heard << service.log();
  hold(service, GetParam().thread);
  if (HasFatalFailure() || IsSkipped()) return;
  manager_.meals_within(3000ms);  // two seconds of standing still are no hang yet
  EXPECT_EQ(manager_.meals_within(1500ms), 0) << service.log();
  EXPECT_NE(service.log().find(std::string(GetParam().told) + " stands still"), std::string::npos) << service.log();
  hung_->release();
  EXPECT_TRUE(manager_.hear("WATCHDOG=1", 3)) << manager_.heard << service.log();
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait_at_most(5), 0) << service.log();
}

INSTANTIATE_TEST_SUITE_P(Threads, WatchdogOfAThread,
                         ::testing::Values(Hang{"vision", "vision"}, Hang{"publish", "publishing"},
                                           Hang{"capture", "camera 0"}, Hang{"klt", ""}, Hang{"surf", ""}),
                         [](const auto& hang) { return std::string(hang.param.thread); });

// What a refinement looks like that gets no processor beside more urgent threads: it may be late, the service goes on.
TEST_F(Watchdog, IsFedOnWhileTheRefinementIsLate) {
  test::RunningService service(test::rendered_dive(), test::kForever, 9);
  ASSERT_TRUE(manager_.hear("STATUS=TRACKING")) << manager_.heard << service.log();
  hold(service, "refine");
  if (HasFatalFailure() || IsSkipped()) return;
  manager_.meals_within(3000ms);
  EXPECT_GE(manager_.meals_within(1500ms), 3) << service.log();
  EXPECT_EQ(service.log().find("stands still"), std::string::npos) << service.log();
  hung_->release();
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait_at_most(5), 0) << service.log();
}

}  // namespace
}  // namespace pelorus
