#include "services/publish_thread.h"

#include <chrono>

#include "services/state_machine.h"

namespace pelorus {
namespace {

constexpr Duration kLongestWait = std::chrono::milliseconds(100);
constexpr Duration kRoomForAsides = std::chrono::milliseconds(3);  // before the next result is due
constexpr Duration kLastResults = std::chrono::milliseconds(300);  // waited for at the end

}  // namespace

PublishThread::PublishThread(PublishDesk& desk, std::vector<Publisher*> publishers, const TimingConfig& config,
                             const CaptureClock& clock, std::function<void()> on_thread_start)
    : desk_(desk),
      publishers_(std::move(publishers)),
      config_(config),
      clock_(clock),
      thread_([this, prepare = std::move(on_thread_start)](const std::stop_token& stop) {
        if (prepare) prepare();
        run(stop);
      }) {}

void PublishThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    turns_.add();
    Duration next = release_due();
    if (next > kRoomForAsides) send_asides();
    for (Publisher* publisher : publishers_) next = std::min(next, publisher->tend());
    desk_.wake.wait(std::min(next, kLongestWait));
  }
  const Timestamp end = clock_.now() + kLastResults;
  for (Duration next = release_due(); next < kLongestWait && clock_.now() < end; next = release_due()) {
    desk_.wake.wait(next);
  }
  send_asides();  // the last health
}

Duration PublishThread::release_due() {
  while (Publication* publication = desk_.results.front()) {
    const Duration left = publication->release_due - clock_.now();
    if (left > Duration::zero()) return left;
    release(*publication);
    desk_.results.release();
  }
  return kLongestWait;
}

void PublishThread::release(Publication& publication) {
  publication.released = clock_.now();
  const Duration late = publication.released - publication.release_due;
  if (seconds(late) * 1e3 > config_.deadline_tolerance_ms) settle_late(publication);
  for (Publisher* publisher : publishers_) publisher->publish(publication);
  const FrameResult& result = publication.result;
  ReleaseSample sample;
  sample.seq = result.seq;
  sample.capture_time = result.capture_time;
  sample.latency = publication.released - result.capture_time;
  sample.late = late;
  sample.step_us = result.report.step_microseconds;
  sample.sigma_px = static_cast<float>(result.report.sigma_px);
  sample.reset_counter = result.reset_counter;
  sample.state = result.state;
  sample.reason = publication.reason;
  sample.deadline_missed = publication.deadline_missed;
  sample.has_picture = publication.has_picture;
  // Full only when the main thread stands still, and then the watchdog speaks.
  (void)desk_.samples.try_push(sample);
}

void PublishThread::send_asides() {
  if (const HealthReport* report = desk_.health.fetch()) {
    for (Publisher* publisher : publishers_) publisher->publish_health(*report);
  }
  if (const PreviewPicture* picture = desk_.previews.fetch()) {
    for (Publisher* publisher : publishers_) publisher->publish_preview(*picture);
  }
}

}  // namespace pelorus
