// The judgements of the doctor on made-up hosts, and its measurement on this one.
#include <gtest/gtest.h>

#include "firmware-host/pelorus/doctor/can_bus.h"
#include "firmware-host/pelorus/doctor/checkup.h"
#include "firmware-host/pelorus/doctor/host_clock.h"
#include "firmware-host/pelorus/doctor/network.h"
#include "firmware-host/pelorus/doctor/scheduling.h"
#include "firmware-host/pelorus/doctor/sources.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::TemporaryFolder;
using test::write_text;

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A delay of `usual_us` but for one in fifty, which is `rare_us`.
WakeupDelays delays_of(double usual_us, double rare_us, bool realtime = true) {
  WakeupDelays delays;
  delays.late_us.assign(980, usual_us);
  delays.late_us.insert(delays.late_us.end(), 20, rare_us);
  delays.realtime = realtime;
  return delays;
}

TEST(Doctor, WakeupsAreJudgedByTheDeadlineTheyUseUp) {
  const TimingConfig timing;  // 5 ms
  EXPECT_EQ(judge_wakeups(delays_of(20, 900), timing, "k").verdict, Verdict::ok);
  EXPECT_EQ(judge_wakeups(delays_of(20, 1100), timing, "k").verdict, Verdict::warn);
  EXPECT_EQ(judge_wakeups(delays_of(20, 5100), timing, "k").verdict, Verdict::fail);
  WakeupDelays one_in_a_thousand = delays_of(20, 20);
  one_in_a_thousand.late_us.back() = 50000;
  EXPECT_EQ(judge_wakeups(one_in_a_thousand, timing, "k").verdict, Verdict::warn);
  EXPECT_EQ(judge_wakeups(WakeupDelays{}, timing, "k").verdict, Verdict::fail);
  EXPECT_TRUE(says(judge_wakeups(delays_of(20, 1100, false), timing, "k").cure, "as root"));
}

TEST(Doctor, TheTimerRunIsBoundedAndMeasuresRealDelays) {
  const auto start = std::chrono::steady_clock::now();
  const WakeupDelays delays = measure_wakeups(std::chrono::milliseconds(200), std::chrono::microseconds(1000));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  ASSERT_GE(delays.late_us.size(), 1U);
  EXPECT_LE(delays.late_us.size(), 200U);
  EXPECT_GE(delays.late_us.front(), 0);  // never before its time
  EXPECT_TRUE(std::is_sorted(delays.late_us.begin(), delays.late_us.end()));
}

TEST(Doctor, GovernorsAreCountedAndAllMustPerform) {
  const TemporaryFolder root;
  const HostFiles files(root.path());
  EXPECT_EQ(check_governor(files).verdict, Verdict::ok);
  for (const char* cpu : {"cpu0", "cpu1"}) {
    write_text(root.path() / "sys/devices/system/cpu" / cpu / "cpufreq/scaling_governor", "performance\n");
  }
  EXPECT_EQ(check_governor(files).verdict, Verdict::ok);
  write_text(root.path() / "sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave\n");
  const HostCheck check = check_governor(files);
  EXPECT_EQ(check.verdict, Verdict::warn);
  EXPECT_TRUE(says(check.found, "powersave on 1")) << check.found;
}

void install_unit(const TemporaryFolder& root, const std::string& service) {
  write_text(root.path() / "usr/lib/systemd/system/pelorusd.service", "[Unit]\nLimitRTPRIO=99\n[Service]\n" + service);
}

TEST(Doctor, TheShippedUnitGrantsWhatTheDefaultsAskFor) {
  const TemporaryFolder root;
  const HostFiles files(root.path());
  ServiceConfig config;
  EXPECT_FALSE(read_unit(files).has_value());
  EXPECT_EQ(check_unit(read_unit(files), config).verdict, Verdict::ok);
  write_text(root.path() / "usr/lib/systemd/system/pelorusd.service",
             test::read_text(PELORUS_SOURCE_DIR "/systemd/pelorusd.service"));
  config.recorder.folder = "/var/lib/pelorus/recordings";
  config.source.kind = "aravis";
  const HostCheck check = check_unit(read_unit(files), config);
  EXPECT_EQ(check.verdict, Verdict::ok) << check.found;
}

TEST(Doctor, DropInsOfTheUnitHaveTheLastWord) {
  const TemporaryFolder root;
  const HostFiles files(root.path());
  install_unit(root, "LimitRTPRIO=50\nLimitMEMLOCK=infinity\nAmbientCapabilities=CAP_NET_RAW\nUser=pelorus\n");
  ServiceConfig config;
  config.recorder.folder = "/var/lib/pelorus/recordings";
  EXPECT_EQ(check_unit(read_unit(files), config).verdict, Verdict::ok);
  write_text(root.path() / "etc/systemd/system/pelorusd.service.d/10-less.conf",
             "[Service]\nLimitRTPRIO=20\nAmbientCapabilities=\n");
  config.source.kind = "aravis";
  const HostCheck check = check_unit(read_unit(files), config);
  EXPECT_EQ(check.verdict, Verdict::warn);
  EXPECT_TRUE(says(check.found, "LimitRTPRIO=20")) << check.found;
  EXPECT_TRUE(says(check.found, "AmbientCapabilities=")) << check.found;
  EXPECT_FALSE(says(check.found, "LimitMEMLOCK")) << check.found;
}

TEST(Doctor, ARelativeFolderOfRecordingsIsNoPlaceForTheService) {
  const TemporaryFolder root;
  install_unit(root, "LimitRTPRIO=50\nLimitMEMLOCK=infinity\n");
  const HostCheck check = check_unit(read_unit(HostFiles(root.path())), ServiceConfig{});
  EXPECT_EQ(check.verdict, Verdict::warn);
  EXPECT_TRUE(says(check.cure, "/var/lib/pelorus")) << check.cure;
}

TEST(Doctor, RefusedPrivilegesAreForgivenWhenTheUnitGrantsThem) {
  const TemporaryFolder root;
  const HostFiles files(root.path());
  EXPECT_EQ(judge_realtime(true, "not permitted", std::nullopt, files).verdict, Verdict::warn);
  EXPECT_EQ(judge_realtime(false, "not permitted", std::nullopt, files).verdict, Verdict::ok);
  EXPECT_EQ(judge_realtime(true, "", std::nullopt, files).verdict, Verdict::ok);
  EXPECT_EQ(judge_memory_lock(true, "8192 kB", std::nullopt).verdict, Verdict::warn);
  install_unit(root, "LimitRTPRIO=50\nLimitMEMLOCK=infinity\n");
  EXPECT_EQ(judge_realtime(true, "not permitted", read_unit(files), files).verdict, Verdict::ok);
  EXPECT_EQ(judge_memory_lock(true, "8192 kB", read_unit(files)).verdict, Verdict::ok);
  write_text(root.path() / "proc/sys/kernel/sched_rt_runtime_us", "0\n");
  EXPECT_EQ(judge_realtime(true, "", read_unit(files), files).verdict, Verdict::fail);
}

TEST(Doctor, LcmUrlsAreReadAsLcmReadsThem) {
  const auto address = parse_lcm_url("udpm://239.255.76.67:7667?recv_buf_size=100&ttl=1");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->group, "239.255.76.67");
  EXPECT_EQ(address->port, 7667);
  EXPECT_EQ(address->ttl, 1);
  EXPECT_EQ(parse_lcm_url("udpm://239.255.76.67:7667")->ttl, 0);
  for (const char* bad : {"file:///tmp/log", "udpm://192.168.0.1:7667", "udpm://239.255.76.67",
                          "udpm://239.255.76.67:0", "udpm://239.255.76.67:7667?ttl=300"}) {
    EXPECT_FALSE(parse_lcm_url(bad)) << bad;
  }
}

TEST(Doctor, MulticastWithoutARouteFailsAndTooFarAReachWarns) {
  const LcmConfig config;
  const LcmAddress here{"239.255.76.67", 7667, 0}, network{"239.255.76.67", 7667, 1}, far{"239.255.76.67", 7667, 8};
  EXPECT_EQ(judge_lcm(config, here, {false, "", "Network is unreachable"}).verdict, Verdict::fail);
  EXPECT_EQ(judge_lcm(config, here, {true, "lo", ""}).verdict, Verdict::ok);
  EXPECT_EQ(judge_lcm(config, network, {true, "lo", ""}).verdict, Verdict::warn);
  EXPECT_EQ(judge_lcm(config, network, {true, "eth0", ""}).verdict, Verdict::ok);
  EXPECT_EQ(judge_lcm(config, far, {true, "eth0", ""}).verdict, Verdict::warn);
  EXPECT_EQ(judge_lcm(config, std::nullopt, {}).verdict, Verdict::fail);
  LcmConfig off;
  off.enabled = false;
  EXPECT_EQ(judge_lcm(off, std::nullopt, {}).verdict, Verdict::ok);
}

TEST(Doctor, SocketBuffersAreMeasuredAgainstTheCameras) {
  const TemporaryFolder root;
  const HostFiles files(root.path());
  ServiceConfig config;
  EXPECT_EQ(check_socket_buffers(files, config, false).verdict, Verdict::warn);  // cannot be read
  write_text(root.path() / "proc/sys/net/core/rmem_max", "212992\n");
  write_text(root.path() / "proc/sys/net/core/rmem_default", "2097152\n");
  EXPECT_EQ(check_socket_buffers(files, config, false).verdict, Verdict::ok);
  config.source.kind = "aravis";
  EXPECT_EQ(check_socket_buffers(files, config, false).verdict, Verdict::fail);
  EXPECT_EQ(check_socket_buffers(files, config, true).verdict, Verdict::ok);  // by packet socket
  config.camera.packet_socket = false;
  EXPECT_EQ(check_socket_buffers(files, config, true).verdict, Verdict::fail);
  write_text(root.path() / "proc/sys/net/core/rmem_max", "4194304\n");
  EXPECT_EQ(check_socket_buffers(files, config, true).verdict, Verdict::ok);
  write_text(root.path() / "proc/sys/net/core/rmem_default", "212992\n");
  EXPECT_EQ(check_socket_buffers(files, config, true).verdict, Verdict::warn);
}

CanLink good_can() {
  CanLink link{true, true, true, true, "can", 500000, 2000000, 100, CanBusState::active};
  return link;
}

TEST(Doctor, CanIsJudgedByTheInterfaceItNames) {
  CanConfig config;
  EXPECT_EQ(judge_can(config, CanLink{}).verdict, Verdict::ok);  // not used
  config.enabled = true;
  EXPECT_EQ(judge_can(config, CanLink{}).verdict, Verdict::fail);
  const HostCheck good = judge_can(config, good_can());
  EXPECT_EQ(good.verdict, Verdict::ok);
  EXPECT_TRUE(says(good.found, "500 kbit/s, data 2000 kbit/s")) << good.found;
  const auto verdict_with = [&](auto change) {
    CanLink link = good_can();
    change(link);
    return judge_can(config, link).verdict;
  };
  EXPECT_EQ(verdict_with([](CanLink& l) { l.is_can = false; }), Verdict::fail);
  EXPECT_EQ(verdict_with([](CanLink& l) { l.bit_rate.reset(); }), Verdict::fail);
  EXPECT_EQ(verdict_with([](CanLink& l) { l.up = false; }), Verdict::fail);
  EXPECT_EQ(verdict_with([](CanLink& l) { l.state = CanBusState::bus_off; }), Verdict::fail);
  EXPECT_EQ(verdict_with([](CanLink& l) { l.state = CanBusState::warning; }), Verdict::warn);
  EXPECT_EQ(verdict_with([](CanLink& l) { l.restart_ms = 0; }), Verdict::warn);
  EXPECT_EQ(verdict_with([](CanLink& l) { l.fd = false; }), Verdict::ok);
  config.fd = true;
  EXPECT_EQ(verdict_with([](CanLink& l) { l.fd = false; }), Verdict::fail);
}

TEST(Doctor, PacketsMustFitThroughTheNetworkToTheCameras) {
  CameraConfig config;
  config.packet_bytes = 9000;
  EXPECT_EQ(judge_packets(config, {{"a", 9000}, {"b", 1500}}).verdict, Verdict::fail);
  EXPECT_EQ(judge_packets(config, {{"a", 9000}, {"b", 9000}}).verdict, Verdict::ok);
  EXPECT_EQ(judge_packets(config, {{"serial", std::nullopt}}).verdict, Verdict::warn);
  config.packet_bytes = 1400;
  EXPECT_EQ(judge_packets(config, {{"a", 1500}}).verdict, Verdict::ok);
  EXPECT_EQ(judge_packets(config, {{"a", 9000}}).verdict, Verdict::warn);
}

TEST(Doctor, AClockThatNobodySetFailsAndOneThatNobodyKeepsWarns) {
  EXPECT_EQ(judge_clock({true, true, 0.01, 2026}, false).verdict, Verdict::ok);
  EXPECT_EQ(judge_clock({true, false, 16, 2026}, false).verdict, Verdict::warn);
  EXPECT_TRUE(says(judge_clock({true, false, 16, 2026}, true).cure, "ptp4l"));
  EXPECT_EQ(judge_clock({true, true, 0.01, 1970}, false).verdict, Verdict::fail);
}

TEST(Doctor, StorageCountsOnlyWhenItShallBeUsedFromTheStart) {
  const TemporaryFolder folder;
  RecorderConfig config;
  config.folder = (folder.path() / "not/yet/there").string();
  config.min_free_gb = 0;
  EXPECT_EQ(check_storage(config, std::nullopt).verdict, Verdict::ok);
  config.min_free_gb = 1e5;
  EXPECT_EQ(check_storage(config, std::nullopt).verdict, Verdict::warn);
  config.at_start = true;
  EXPECT_EQ(check_storage(config, std::nullopt).verdict, Verdict::fail);
  config.min_free_gb = 0;
  // A flow that fills any disk within ten minutes.
  EXPECT_EQ(check_storage(config, PairFlow{1'000'000'000'000'000, 20}).verdict, Verdict::warn);
  write_text(folder.path() / "file", "no folder");
  config.folder = (folder.path() / "file").string();
  EXPECT_EQ(check_storage(config, std::nullopt).verdict, Verdict::fail);
}

const HostCheck& topic(const std::vector<HostCheck>& checks, const std::string& name) {
  static const HostCheck none{Verdict::fail, "missing", "no such topic", ""};
  for (const HostCheck& check : checks)
    if (check.topic == name) return check;
  return none;
}

TEST(Doctor, EverySourceHasALineAndTheConfiguredOneIsTried) {
  ServiceConfig config;
  config.source.kind = "synthetic";
  config.source.path = PELORUS_SOURCE_DIR "/config/scenes/paper.yaml";
  std::vector<HostCheck> checks = check_sources(config, true).checks;
  for (const char* kind : {"replay", "synthetic", "v4l2", "aravis"}) {
    const HostCheck& check = topic(checks, std::string("source ") + kind);
    EXPECT_EQ(check.verdict, Verdict::ok) << kind << ": " << check.found;
  }
  EXPECT_TRUE(says(topic(checks, "source synthetic").found, "opens"));
  config.source.kind = "replay";  // of a scene file
  checks = check_sources(config, true).checks;
  EXPECT_EQ(topic(checks, "source replay").verdict, Verdict::fail);
  config.source.path.clear();
  EXPECT_EQ(topic(check_sources(config, true).checks, "source replay").verdict, Verdict::fail);
  EXPECT_EQ(topic(check_sources(config, false).checks, "source replay").verdict, Verdict::ok);
}

TEST(Doctor, CamerasThatAreNotThereFailWithTheirNames) {
  ServiceConfig config;
  config.source.kind = "v4l2";
  config.camera.left = "/dev/video_of_nobody";
  std::vector<HostCheck> checks = check_sources(config, true).checks;
  EXPECT_EQ(topic(checks, "source v4l2").verdict, Verdict::fail);
  EXPECT_TRUE(says(topic(checks, "source v4l2").found, "/dev/video_of_nobody")) << topic(checks, "source v4l2").found;
  EXPECT_EQ(topic(checks, "calibration").verdict, Verdict::fail);
  config.source.kind = "aravis";
  config.camera.left = "127.0.0.201";
  config.camera.right = "127.0.0.202";
  checks = check_sources(config, true).checks;
  EXPECT_EQ(topic(checks, "source aravis").verdict, Verdict::fail);
  EXPECT_TRUE(says(topic(checks, "source aravis").found, "127.0.0.201; 127.0.0.202 does not answer"));
  EXPECT_TRUE(says(topic(checks, "packet size").found, "to 127.0.0.201 at most 6553"))
      << topic(checks, "packet size").found;
}

TEST(Doctor, LinesTellTheCureAndCountTheFailures) {
  const std::vector<HostCheck> checks = {{Verdict::ok, "a", "fine", ""},
                                         {Verdict::fail, "bus", "no \"can0\"", "load it"}};
  EXPECT_EQ(checks_text(checks),
            "OK    a    fine\n"
            "FAIL  bus  no \"can0\"\n"
            "           -> load it\n"
            "2 checks, 0 WARN, 1 FAIL: not ready to dive\n");
  EXPECT_EQ(checks_json(checks),
            R"({"checks":[{"topic":"a","verdict":"OK","found":"fine","cure":""},)"
            R"({"topic":"bus","verdict":"FAIL","found":"no \"can0\"","cure":"load it"}],"warnings":0,"failures":1})");
}

}  // namespace
}  // namespace pelorus
