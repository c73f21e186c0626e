#include "services/publish_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <mutex>
#include <thread>

namespace pelorus {
namespace {

class Sink final : public Publisher {
 public:
  void publish(const Publication& publication) override {
    if (gate_.valid()) gate_.wait();
    const std::scoped_lock lock(mutex_);
    all_.push_back(publication);
  }
  void publish_health(const HealthReport& report) override { health = report.seq; }
  void publish_preview(const PreviewPicture&) override { ++previews; }
  // publish() waits in the kernel until the promise is kept.
  void hold(std::shared_future<void> gate) { gate_ = std::move(gate); }
  std::vector<Publication> all() const {
    const std::scoped_lock lock(mutex_);
    return all_;
  }
  bool wait_for(std::size_t count) const {
    for (int i = 0; i < 400 && all().size() < count; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return all().size() >= count;
  }
  std::atomic<std::uint64_t> health{0};
  std::atomic<int> previews{0};

 private:
  mutable std::mutex mutex_;
  std::vector<Publication> all_;
  std::shared_future<void> gate_;
};

class Publishing : public ::testing::Test {
 protected:
  void post(std::uint64_t seq, Duration due_in) {
    Publication& p = desk_.results.draft();
    p = Publication{};
    p.result.seq = seq;
    p.result.capture_time = clock_.now();
    p.result.state = VisionState::tracking;
    p.result.pose_valid = true;
    p.release_due = clock_.now() + due_in;
    (void)desk_.results.post();
  }
  CaptureClock clock_;
  PublishDesk desk_;
  Sink sink_;
  TimingConfig config_{.latency_ms = 50, .deadline_tolerance_ms = 2000};  // a loaded machine shall not fail the test
};

TEST_F(Publishing, ResultsLeaveInOrderAndNotBeforeTheirMoment) {
  const PublishThread thread(desk_, {&sink_}, config_, clock_);
  for (std::uint64_t i = 1; i <= 5; ++i) post(i, std::chrono::milliseconds(20 * i));
  ASSERT_TRUE(sink_.wait_for(5));
  const auto all = sink_.all();
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(all[i].result.seq, i + 1);
    EXPECT_GE(all[i].released, all[i].release_due);
    EXPECT_FALSE(all[i].deadline_missed);
    EXPECT_EQ(all[i].result.state, VisionState::tracking);
  }
}

TEST_F(Publishing, AResultThatComesTooLateIsFlaggedAndDegraded) {
  config_.deadline_tolerance_ms = 5;
  const PublishThread thread(desk_, {&sink_}, config_, clock_);
  post(1, -std::chrono::milliseconds(20));
  ASSERT_TRUE(sink_.wait_for(1));
  EXPECT_TRUE(sink_.all()[0].deadline_missed);
  EXPECT_EQ(sink_.all()[0].result.state, VisionState::degraded);
  const auto sample = desk_.samples.try_pop();
  ASSERT_TRUE(sample.has_value());
  EXPECT_TRUE(sample->deadline_missed);
  EXPECT_GE(sample->late, std::chrono::milliseconds(20));
}

TEST_F(Publishing, APublisherThatIsStuckNeverStopsTheProducer) {
  std::promise<void> free;
  sink_.hold(free.get_future().share());
  const PublishThread thread(desk_, {&sink_}, config_, clock_);
  constexpr std::uint64_t kPosted = 100;
  for (std::uint64_t i = 1; i <= kPosted; ++i) post(i, Duration::zero());  // returns, though nothing leaves
  EXPECT_GT(desk_.results.dropped(), 0U);
  free.set_value();
  ASSERT_TRUE(sink_.wait_for(kPosted - desk_.results.dropped()));
  EXPECT_EQ(sink_.all().size() + desk_.results.dropped(), kPosted) << "every result was published or counted";
}

TEST_F(Publishing, HealthAndPreviewsLeaveBetweenResults) {
  const PublishThread thread(desk_, {&sink_}, config_, clock_);
  desk_.health.draft().seq = 9;
  desk_.health.post();
  desk_.previews.post();
  desk_.wake.ring();
  for (int i = 0; i < 400 && (sink_.health != 9 || sink_.previews != 1); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(sink_.health, 9U);
  EXPECT_EQ(sink_.previews, 1);
}

TEST_F(Publishing, ResultsUnderWayAreStillReleasedAtTheEnd) {
  {
    const PublishThread thread(desk_, {&sink_}, config_, clock_);
    post(1, std::chrono::milliseconds(60));
    post(2, std::chrono::milliseconds(80));
  }
  EXPECT_EQ(sink_.all().size(), 2U);
}

// For the race detector: a producer and a consumer at full speed, content checked.
TEST(ResultRing, KeepsOrderAndContentUnderContention) {
  Wake wake;
  ResultRing ring(4, wake);
  constexpr std::uint64_t kCount = 20000;
  std::jthread producer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      Publication& p = ring.draft();
      p.result.seq = i;
      p.pairs_dropped = i;
      (void)ring.post();
    }
    Publication& p = ring.draft();
    p.result.seq = kCount + 1;
    while (!ring.post()) std::this_thread::yield();
  });
  std::uint64_t last = 0, received = 0;
  while (last <= kCount) {
    const Publication* p = ring.front();
    if (p == nullptr) {
      wake.wait(std::chrono::milliseconds(10));
      continue;
    }
    EXPECT_GT(p->result.seq, last);
    if (p->result.seq <= kCount) {
      EXPECT_EQ(p->pairs_dropped, p->result.seq);
      ++received;
    }
    last = p->result.seq;
    ring.release();
  }
  producer.join();
  EXPECT_GE(received + ring.dropped(), kCount);
}

}  // namespace
}  // namespace pelorus
