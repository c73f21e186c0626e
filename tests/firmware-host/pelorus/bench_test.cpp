#include <gtest/gtest.h>

#include <thread>

#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"
#include "firmware-host/pelorus/bench/allocation_counter.h"
#include "firmware-host/pelorus/bench/latency_picture.h"
#include "firmware-host/pelorus/bench/latency_report.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

std::shared_ptr<const PreloadedPairs> small_dive(std::size_t count) {
  const auto scene = synthetic::load_scene(PELORUS_SOURCE_DIR "/tests/golden/small_dive.yaml");
  EXPECT_TRUE(scene.ok());
  synthetic::SyntheticSource source(scene.value(), 0);
  auto pairs = preload(source, count);
  EXPECT_TRUE(pairs.ok());
  return pairs.value();
}

TEST(PreloadedSource, ShowsItsPairsThereAndBackAgain) {
  const auto held = small_dive(4);
  ASSERT_EQ(held->pairs.size(), 4U);
  PreloadedSource source(held);
  SourcePair pair;
  const std::array<std::size_t, 9> order{0, 1, 2, 3, 2, 1, 0, 1, 2};
  for (std::size_t k = 0; k < order.size(); ++k) {
    ASSERT_TRUE(source.next(pair).value());
    EXPECT_EQ(pair.seq, k);
    const Image& expected = held->pairs[order[k]].right;
    ASSERT_EQ(pair.right.width(), expected.width());
    bool equal = true;
    for (int v = 0; v < expected.height(); ++v) {
      equal = equal && std::equal(expected.row(v), expected.row(v) + expected.width(), pair.right.row(v));
    }
    EXPECT_TRUE(equal) << k;
  }
}

TEST(PreloadedSource, TwoPairsAreTooFew) {
  const auto scene = synthetic::load_scene(PELORUS_SOURCE_DIR "/tests/golden/small_dive.yaml");
  synthetic::SyntheticSource source(scene.value(), 0);
  const auto pairs = preload(source, 2);
  ASSERT_FALSE(pairs.ok());
  EXPECT_NE(pairs.error().message().find("only 2 pairs"), std::string::npos);
}

TEST(Distribution, TakesRanksOfTheSortedValues) {
  Distribution d{"step", "ms", {}};
  EXPECT_TRUE(std::isnan(d.at(0.5)));
  for (int k = 0; k <= 1000; ++k) d.values.push_back(k);
  EXPECT_EQ(d.at(0), 0);
  EXPECT_EQ(d.at(0.5), 500);
  EXPECT_EQ(d.at(0.999), 999);
  EXPECT_EQ(d.at(1), 1000);
}

TEST(AllocationCounter, CountsTheThreadsItWasToldToAndNoOther) {
  if (!allocations_are_counted()) GTEST_SKIP() << "sanitizers bring an allocator of their own";
  const auto allocate = [] {
    std::vector<int>* made = new std::vector<int>(100);
    asm volatile("" : : "r"(made->data()) : "memory");
    delete made;
  };
  const std::uint64_t before = counted_allocations();
  allocate();
  EXPECT_EQ(counted_allocations(), before);
  std::thread([&] {
    count_allocations_of_this_thread();
    allocate();
  }).join();
  EXPECT_GE(counted_allocations(), before + 2);
}

TEST(BenchLatency, RunsTheServicesThreadsAndAccountsForEachResult) {
  const auto pairs = small_dive(8);
  LatencyContext context;
  context.dataset = "small \"dive\"";
  context.width = pairs->calibration.left.width;
  context.height = pairs->calibration.left.height;
  context.options.rate_hz = 10;
  context.options.seconds = 2;
  context.options.warm_up_s = 1;
  context.options.config.process.realtime = context.options.config.process.lock_memory = false;
  context.options.config.timing.latency_ms = 90;
  const auto ran = run_latency(pairs, context.options);
  ASSERT_TRUE(ran.ok());
  const LatencyRun& run = ran.value();
  EXPECT_FALSE(run.interrupted);
  // Twenty are due; a loaded machine may pass over some or feed them late, and says so.
  EXPECT_GE(run.steps.size() + run.pairs_superseded + run.pairs_late, 17U);
  EXPECT_LE(run.steps.size(), 23U);
  int with_pose = 0;
  for (const ReleasedStep& step : run.steps) {
    with_pose += step.pose_valid;
    EXPECT_GE(step.released_ms, 90.0);
    EXPECT_GT(step.ready_ms, 0);
    EXPECT_GT(step.report.step_microseconds, 100);
    EXPECT_LE(step.report.step_microseconds * 1e-3, step.ready_ms);
  }
  EXPECT_EQ(with_pose, static_cast<int>(run.steps.size()));
  if (allocations_are_counted()) {
    EXPECT_EQ(run.allocations, 0U);
  }
  EXPECT_GT(run.rss_start_mb, 1);
  double vision_ms = 0;
  for (const ThreadCost& thread : run.threads) vision_ms += thread.name == "vision" ? thread.cpu_ms : 0;
  EXPECT_GT(vision_ms, 5);

  const std::string json = latency_json(context, run);
  EXPECT_NE(json.find("\"dataset\":\"small \\\"dive\\\"\""), std::string::npos) << json;
  EXPECT_NE(json.find("\"results\":" + std::to_string(run.steps.size())), std::string::npos);
  EXPECT_NE(latency_table(context, run).find("deadlines missed"), std::string::npos);
  const test::TemporaryFolder folder;
  EXPECT_TRUE(write_latency_picture(folder.path() / "histogram.png", context, run).ok());
  EXPECT_GT(std::filesystem::file_size(folder.path() / "histogram.png"), 1000U);
  EXPECT_FALSE(write_latency_picture(folder.path() / "none" / "histogram.png", context, run).ok());
}

TEST(BenchLatency, EndsWhenAsked) {
  LatencyOptions options;
  options.seconds = 600;
  options.warm_up_s = 0.1;
  options.config.process.realtime = options.config.process.lock_memory = false;
  int asked = 0;
  options.stop = [&asked] { return ++asked > 4; };
  const auto run = run_latency(small_dive(3), options);
  ASSERT_TRUE(run.ok());
  EXPECT_TRUE(run.value().interrupted);
  EXPECT_LT(run.value().seconds, 30);
}

}  // namespace
}  // namespace pelorus
