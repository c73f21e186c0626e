// VIS_HEALTH of the service as a process of its own: what the system granted it, and a disk that fills up.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <algorithm>
#include <fstream>

#include "drivers/replay/dataset.h"
#include "tests/firmware-host/pelorusd/running_service.h"

namespace pelorus {
namespace {

using test::RunningService;
using test::TemporaryFolder;

class HealthMessages : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::lcm_available()) GTEST_SKIP() << "no multicast route: ip route add 224.0.0.0/4 dev lo";
  }
};

// What the kernel says of a process.
struct KernelFacts {
  explicit KernelFacts(pid_t process) {
    const std::filesystem::path folder = "/proc/" + std::to_string(process);
    std::istringstream status(test::read_text(folder / "status"));
    for (std::string word; status >> word;) {
      if (word == "VmLck:") status >> locked_kb;
    }
    for (const auto& task : std::filesystem::directory_iterator(folder / "task")) {
      const pid_t thread = std::stoi(task.path().filename());
      cpu_set_t allowed;
      if (::sched_getaffinity(thread, sizeof allowed, &allowed) == 0) pinned += CPU_COUNT(&allowed) == 1 ? 1 : 0;
      if (test::read_text(task.path() / "comm") == "vision\n") realtime = ::sched_getscheduler(thread) == SCHED_FIFO;
    }
  }
  long locked_kb = 0;
  int pinned = 0;
  bool realtime = false;
};

TEST_F(HealthMessages, PrivilegesAreThoseThatTheKernelShows) {
  RunningService service(test::rendered_dive(), test::kForever, 14);
  ASSERT_TRUE(service.wait_for_state("TRACKING")) << service.log();
  ASSERT_TRUE(service.health.wait_for(2, 20)) << service.log();
  const KernelFacts facts(service.process->id());
  const std::string text = service.health.messages.back().privileges_text;
  EXPECT_EQ(text.starts_with("real time, "), facts.realtime) << text;
  EXPECT_EQ(text.find(", memory locked") != std::string::npos, facts.locked_kb > 0) << text;
  const std::string pinned = facts.pinned > 0 ? std::to_string(facts.pinned) : "no";
  EXPECT_NE(text.find(", " + pinned + " threads pinned"), std::string::npos) << text;
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait(), 0);
}

TEST_F(HealthMessages, WhatIsNotAskedForIsNotGranted) {
  RunningService service(test::rendered_dive(), test::kForever + "process:\n  realtime: false\n  lock_memory: false\n",
                         15);
  ASSERT_TRUE(service.health.wait_for(2, 20)) << service.log();
  const KernelFacts facts(service.process->id());
  EXPECT_FALSE(facts.realtime);
  EXPECT_EQ(facts.pinned, 0);
  EXPECT_EQ(service.health.messages.back().privileges_text,
            "real time not asked for, memory lock not asked for, no threads pinned");
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait(), 0);
}

// The pairs of a recording; and when the last of them was taken.
struct Recorded {
  explicit Recorded(const std::filesystem::path& folder) {
    auto source = open_dataset(folder);
    EXPECT_TRUE(source.ok()) << source.error().message();
    if (!source.ok()) return;
    SourcePair pair;
    for (; source.value()->next(pair).value(); ++pairs) last_utime = pair.capture_time.ns / 1000;
  }
  std::int64_t pairs = 0;
  std::int64_t last_utime = 0;
};

// A real, small disk. Twice, so that a report of the ordinary rhythm is not mistaken for one in time.
TEST_F(HealthMessages, AFullDiskIsToldWithinFivePairs) {
  constexpr double kRate_hz = 20;
  const TemporaryFolder folder;
  const std::string disk = (folder.path() / "disk").string();
  std::filesystem::create_directory(disk);
  if (mount("none", disk.c_str(), "tmpfs", 0, "size=4m") != 0) GTEST_SKIP() << "mounting is not permitted";
  const std::unique_ptr<const std::string, void (*)(const std::string*)> mounted(
      &disk, [](const std::string* at) { umount2(at->c_str(), MNT_DETACH); });
  RunningService service(
      "source:\n  path: \"" + test::rendered_dive().string() + "\"\n  repeat: true\n  rate_hz: 20\n",
      test::kPatient + "recorder:\n  at_start: true\n  format: pgm\n  min_free_gb: 0.001\n  folder: \"" + disk + "\"\n",
      17);
  std::size_t seen = 0;
  const auto told = [&](const std::string& what) -> const vis_health_t* {
    const auto matches = [&](const vis_health_t& m) { return m.recorder_text.starts_with(what); };
    const auto& all = service.health.messages;
    const auto first = [&] {
      return std::find_if(all.begin() + static_cast<std::ptrdiff_t>(seen), all.end(), matches);
    };
    if (!service.health.wait([&] { return first() != all.end(); }, 20)) return nullptr;
    seen = static_cast<std::size_t>(first() - all.begin());
    return &all[seen];
  };
  std::int64_t written = 0;
  for (int round = 0; round < 2; ++round) {
    ASSERT_NE(told("recording " + disk), nullptr) << service.log();
    const vis_health_t* full = told("disk full: ");
    ASSERT_NE(full, nullptr) << service.log();
    const std::filesystem::path recording = std::filesystem::directory_iterator(disk)->path();
    const Recorded recorded(recording);
    EXPECT_GT(recorded.pairs, 5);
    // The first pair that found no room came one period after the last that did.
    EXPECT_LE(static_cast<double>(full->utime - recorded.last_utime), 6e6 / kRate_hz) << "told within five pairs";
    written += recorded.pairs;
    EXPECT_EQ(full->recorder_pairs_written, written);
    EXPECT_EQ(full->recorder_pairs_failed, round + 1);
    std::filesystem::remove_all(recording);
  }
  const vis_health_t& last = service.health.messages.back();
  EXPECT_LE(static_cast<double>(service.health.messages.size()), last.uptime_s + 6) << "one a second and one a change";
  service.process->send(SIGTERM);
  EXPECT_EQ(service.process->wait(), 0);
}

}  // namespace
}  // namespace pelorus
