#include "firmware-host/runtime/service_manager.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstring>

#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

// The service manager's end of NOTIFY_SOCKET.
class Notified : public ::testing::Test {
 protected:
  ~Notified() override {
    if (fd_ >= 0) ::close(fd_);
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }
  void listen(const std::string& name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    if (name[0] == '@') address.sun_path[0] = '\0';
    fd_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    ASSERT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), length), 0);
    setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  std::string heard() const {
    std::array<char, 256> text{};
    const ssize_t length = ::recv(fd_, text.data(), text.size(), 0);
    return length < 0 ? "" : std::string(text.data(), static_cast<std::size_t>(length));
  }
  int fd_ = -1;
};

TEST_F(Notified, StatesArriveAtASocketInTheFileSystem) {
  const test::TemporaryFolder folder;
  listen((folder.path() / "notify").string());
  EXPECT_TRUE(ServiceManager().notify("READY=1\nSTATUS=TRACKING"));
  EXPECT_EQ(heard(), "READY=1\nSTATUS=TRACKING");
}

TEST_F(Notified, StatesArriveAtAnAbstractSocket) {
  listen("@pelorus-test-" + std::to_string(::getpid()));
  EXPECT_TRUE(ServiceManager().notify("WATCHDOG=1"));
  EXPECT_EQ(heard(), "WATCHDOG=1");
}

TEST_F(Notified, StartedByHandNobodyIsTold) {
  unsetenv("NOTIFY_SOCKET");
  EXPECT_FALSE(ServiceManager().notify("READY=1"));
  EXPECT_FALSE(ServiceManager().watchdog().has_value());
}

TEST_F(Notified, WatchdogIsOursOnlyWhenMeantForThisProcess) {
  setenv("WATCHDOG_USEC", "3000000", 1);
  EXPECT_EQ(ServiceManager().watchdog(), std::chrono::seconds(3));
  setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  EXPECT_EQ(ServiceManager().watchdog(), std::chrono::seconds(3));
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(ServiceManager().watchdog().has_value());
}

}  // namespace
}  // namespace pelorus
