// `pelorus top` as a process of its own: on the bus of a real service, and on a pseudo terminal.
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <yaml-cpp/yaml.h>
#include <pelorus/vis_tracks_t.hpp>

#include <thread>

#include "tests/firmware-host/pelorusd/running_service.h"

namespace pelorus::test {
namespace {

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::vector<std::string> top_command(const std::string& url, std::vector<std::string> more) {
  std::vector<std::string> command{PELORUS_TOOL, "top", "--url", url, "--vehicle", "TEST"};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

// Ours on one end, `pelorus top` on the other.
class TopOnATerminal {
 public:
  explicit TopOnATerminal(const std::string& url) {
    winsize size{24, 80, 0, 0};
    EXPECT_EQ(::openpty(&ours_, &theirs_, nullptr, nullptr, &size), 0);
    ::tcgetattr(theirs_, &before_);
    pid_ = ::fork();
    if (pid_ != 0) return;
    ::setsid();
    ::ioctl(theirs_, TIOCSCTTY, 0);
    for (const int fd : {0, 1, 2}) ::dup2(theirs_, fd);
    ::setenv("TERM", "xterm", 1);
    ::unsetenv("NO_COLOR");
    ::execl(PELORUS_TOOL, PELORUS_TOOL, "top", "--url", url.c_str(), "--vehicle", "TEST", nullptr);
    ::_exit(99);
  }
  ~TopOnATerminal() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(ours_);
    ::close(theirs_);
  }
  TopOnATerminal(const TopOnATerminal&) = delete;
  TopOnATerminal& operator=(const TopOnATerminal&) = delete;

  // Reads the screen's bytes until they hold `part`; false after 20 s.
  bool wait_for(const std::string& part) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < end) {
      if (says(screen, part)) return true;
      pollfd readable{ours_, POLLIN, 0};
      std::array<char, 4096> some{};
      if (::poll(&readable, 1, 50) <= 0) continue;
      const ssize_t size = ::read(ours_, some.data(), some.size());
      if (size > 0) screen.append(some.data(), static_cast<std::size_t>(size));
    }
    return false;
  }
  void type(const char* keys) const { EXPECT_GT(::write(ours_, keys, std::strlen(keys)), 0); }
  void resize(unsigned short rows, unsigned short columns) const {
    const winsize size{rows, columns, 0, 0};
    EXPECT_EQ(::ioctl(ours_, TIOCSWINSZ, &size), 0);
  }
  int finish() {
    int status = 0;
    for (int i = 0; i < 2000; ++i) {
      if (::waitpid(pid_, &status, WNOHANG) == pid_) {
        pid_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return -2;
  }
  [[nodiscard]] bool modes_restored() const {
    termios now{};
    ::tcgetattr(theirs_, &now);
    return now.c_lflag == before_.c_lflag && std::memcmp(now.c_cc, before_.c_cc, sizeof now.c_cc) == 0;
  }
  [[nodiscard]] bool echoes() const {
    termios now{};
    ::tcgetattr(theirs_, &now);
    return (now.c_lflag & ECHO) != 0;
  }
  std::string screen;

 private:
  int ours_ = -1;
  int theirs_ = -1;
  pid_t pid_ = -1;
  termios before_{};
};

TEST(Top, ShowsWhatARunningServiceSays) {
  if (!lcm_available()) GTEST_SKIP() << "no multicast route";
  const TemporaryFolder folder;
  RunningService service(rendered_dive(), "# repeat\n", 21);
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  ChildProcess top(top_command(service.url(), {"--once", "--json", "--timeout", "20"}), folder.path() / "top.json");
  ASSERT_EQ(top.wait_at_most(30), 0) << read_text(folder.path() / "top.json");
  const YAML::Node json = YAML::Load(read_text(folder.path() / "top.json"));
  EXPECT_EQ(json["vehicle"].as<std::string>(), "TEST");
  EXPECT_TRUE(json["odom"]["pose_valid"].IsDefined());
  EXPECT_FALSE(json["odom"]["stale"].as<bool>());
  EXPECT_GT(json["odom"]["utime"].as<long long>(), 1'600'000'000'000'000);
  // What is shown is what another listener heard.
  const auto utime = json["health"]["utime"].as<std::int64_t>();
  const vis_health_t* same = nullptr;
  service.health.wait([&] {
    for (const vis_health_t& m : service.health.messages) same = m.utime == utime ? &m : same;
    return same != nullptr;
  });
  ASSERT_NE(same, nullptr);
  EXPECT_EQ(json["health"]["pairs_captured"].as<std::int64_t>(), same->pairs_captured);
  EXPECT_NEAR(json["health"]["results_rate_hz"].as<double>(), same->results_rate_hz, 1e-6);
  EXPECT_NEAR(json["health"]["wall_step_s"].as<double>(), 0, 0.1);  // nobody sets the clock meanwhile
  EXPECT_GT(json["health"]["disk_free_gb"].as<double>(), 0);        // of a folder that is not there yet
  EXPECT_EQ(json["health"]["can"].as<std::string>(), "off");
  EXPECT_TRUE(json["tracks"]["bodies"].IsSequence());

  // On a terminal the same service shows, and goes stale there when it is gone.
  TopOnATerminal terminal(service.url());
  EXPECT_TRUE(terminal.wait_for("TRACKING")) << terminal.screen;
  EXPECT_TRUE(terminal.wait_for("pelorusd " PELORUS_VERSION)) << terminal.screen;
  service.process->send(SIGKILL);
  EXPECT_TRUE(terminal.wait_for("STALE")) << terminal.screen;
  terminal.type("q");
  EXPECT_EQ(terminal.finish(), 0);
}

TEST(Top, OnceWithoutAServiceEndsInTimeAndNamesTheChannels) {
  if (!lcm_available()) GTEST_SKIP() << "no multicast route";
  const TemporaryFolder folder;
  ChildProcess top(top_command(loopback_url(22), {"--once", "--json", "--timeout", "0.3"}), folder.path() / "out");
  EXPECT_EQ(top.wait_at_most(10), 1);
  const std::string said = read_text(folder.path() / "out");
  EXPECT_TRUE(says(said, "TEST.VIS_ODOM, TEST.VIS_TRACKS, TEST.VIS_HEALTH")) << said;
  EXPECT_TRUE(says(said, "pelorusd")) << said;
}

TEST(Top, OnceNamesOnlyTheChannelThatIsMissing) {
  if (!lcm_available()) GTEST_SKIP() << "no multicast route";
  const TemporaryFolder folder;
  const std::string url = loopback_url(23);
  lcm::LCM bus(url);
  ChildProcess top(top_command(url, {"--once", "--timeout", "2"}), folder.path() / "out");
  int code = -2;
  while ((code = top.wait_at_most(0.05)) == -2) {
    vis_odom_t odom{};
    vis_tracks_t tracks{};
    bus.publish("TEST.VIS_ODOM", &odom);
    bus.publish("TEST.VIS_TRACKS", &tracks);
    bus.publish("TESTxVIS_HEALTH", &odom);  // not ours
  }
  EXPECT_EQ(code, 1);
  const std::string said = read_text(folder.path() / "out");
  EXPECT_TRUE(says(said, "on TEST.VIS_HEALTH (")) << said;
}

TEST(Top, CtrlCPutsTheTerminalBackAsItWas) {
  TopOnATerminal terminal(loopback_url(24));
  ASSERT_TRUE(terminal.wait_for("NOT HEARD YET")) << terminal.screen;
  EXPECT_TRUE(terminal.screen.starts_with("\033[?1049h\033[?25l")) << terminal.screen;
  EXPECT_FALSE(terminal.echoes());
  terminal.type("\x03");
  EXPECT_EQ(terminal.finish(), 0);
  EXPECT_TRUE(terminal.wait_for("\033[?25h\033[?1049l")) << terminal.screen;
  EXPECT_TRUE(terminal.modes_restored());
}

TEST(Top, FollowsTheSizeOfTheTerminal) {
  TopOnATerminal terminal(loopback_url(25));
  ASSERT_TRUE(terminal.wait_for("q or Ctrl-C ends")) << terminal.screen;
  terminal.screen.clear();
  terminal.resize(10, 40);
  // The foot line then stands on the tenth row: nine line ends after the start of a page.
  EXPECT_TRUE(terminal.wait_for("pelorus top")) << terminal.screen;
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  terminal.screen.clear();
  ASSERT_TRUE(terminal.wait_for("\033[J\033[H") && terminal.wait_for("\033[J"));
  const std::size_t start = terminal.screen.find("\033[H");
  ASSERT_TRUE(start != std::string::npos);
  ASSERT_TRUE(terminal.wait_for("Ctrl-C ends"));
  const std::string page = terminal.screen.substr(start, terminal.screen.find("\033[J", start) - start);
  int line_ends = 0;
  for (std::size_t at = page.find("\r\n"); at != std::string::npos; at = page.find("\r\n", at + 1)) ++line_ends;
  EXPECT_EQ(line_ends, 9) << page;
}

TEST(Top, ExplainsItself) {
  const TemporaryFolder folder;
  ChildProcess top({PELORUS_TOOL, "top", "--help"}, folder.path() / "out");
  EXPECT_EQ(top.wait_at_most(10), 0);
  EXPECT_TRUE(says(read_text(folder.path() / "out"), "Exit codes"));
}

TEST(Top, AFileGetsPlainPages) {
  const TemporaryFolder folder;
  ChildProcess top(top_command(loopback_url(26), {}), folder.path() / "out");
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!says(read_text(folder.path() / "out"), "Ctrl-C ends") && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  top.send(SIGINT);
  EXPECT_EQ(top.wait_at_most(10), 0);
  const std::string said = read_text(folder.path() / "out");
  EXPECT_TRUE(says(said, "NOT HEARD YET")) << said;
  EXPECT_FALSE(says(said, "\033")) << said;
}

}  // namespace
}  // namespace pelorus::test
