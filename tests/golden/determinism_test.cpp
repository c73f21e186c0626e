// Same frames in, same bytes out: again, and whatever the number of processors and threads.
#include <gtest/gtest.h>
#include <sched.h>

#include "tests/golden/small_dive.h"

namespace pelorus {
namespace {

// The calling thread, and those it starts, on one processor for the guard's life.
class OneProcessor {
 public:
  OneProcessor() {
    sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu) {
      if (CPU_ISSET(cpu, &before_)) CPU_SET(cpu, &one);
    }
    sched_setaffinity(0, sizeof one, &one);
  }
  ~OneProcessor() { sched_setaffinity(0, sizeof before_, &before_); }

 private:
  cpu_set_t before_{};
};

void expect_same_bytes(const test::TemporaryFolder& a, const test::TemporaryFolder& b) {
  for (const char* name : {"camera.tum", "objects.csv", "frames.csv", "points.csv", "outlines.csv"}) {
    const std::string text = test::read_text(a.path() / name);
    EXPECT_GT(text.size(), 100U) << name << " holds next to nothing: the comparison would mean nothing";
    EXPECT_EQ(text, test::read_text(b.path() / name)) << name;
  }
  const std::string lost = test::read_text(a.path() / "lost_pairs.csv");
  EXPECT_NE(lost.find("\n0,0,0\n"), std::string::npos) << lost;
  EXPECT_EQ(lost, test::read_text(b.path() / "lost_pairs.csv"));
}

TEST(Determinism, SameDiveGivesTheSameBytesOnOneProcessorAndOnAll) {
  const test::TemporaryFolder all;
  const test::TemporaryFolder one;
  test::replay_small_dive(all, 3);
  {
    const OneProcessor guard;
    test::replay_small_dive(one, 1);
  }
  expect_same_bytes(all, one);
}

TEST(Determinism, SharingAStepAmongThreadsChangesNoByte) {
  const test::TemporaryFolder shared;
  const test::TemporaryFolder alone;
  test::replay_small_dive(shared, 1, true);
  test::replay_small_dive(alone, 1, false);
  expect_same_bytes(shared, alone);
}

TEST(Determinism, SameDiveTwiceGivesTheSameBytes) {
  const test::TemporaryFolder once;
  const test::TemporaryFolder again;
  test::replay_small_dive(once, 0);
  test::replay_small_dive(again, 0);
  expect_same_bytes(once, again);
}

}  // namespace
}  // namespace pelorus
