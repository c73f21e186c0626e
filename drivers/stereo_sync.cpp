#include "drivers/stereo_sync.h"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

namespace pelorus {
namespace {

constexpr int kUnmatchedUntilRealigned = 3;

std::int64_t error_ns(const FrameLease& left, const FrameLease& right) {
  return right->mid_exposure.ns - left->mid_exposure.ns;
}

}  // namespace

StereoSync::StereoSync(FrameRing& both_views) { left_.ring = &both_views; }

StereoSync::StereoSync(FrameRing& left, FrameRing& right, const StereoSyncConfig& config)
    : config_(config), tolerance_ns_(std::llround(config.tolerance_ms * 1e6)) {
  left_.ring = &left;
  right_.ring = &right;
}

StereoPair StereoSync::newest(Duration timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    StereoPair pair = right_.ring == nullptr ? newest_of_device() : newest_of_waiting();
    const Duration left = deadline - std::chrono::steady_clock::now();
    if (pair) note_delivered(pair);
    if (pair || left <= Duration::zero()) return pair;
    wait_for_frames(left);
  }
}

SyncStatistics StereoSync::statistics() const {
  SyncStatistics s;
  s.pairs = pairs_.value();
  s.superseded = superseded_.value();
  s.unpaired_left = left_.unpaired.value();
  s.unpaired_right = right_.unpaired.value();
  s.out_of_tolerance = out_of_tolerance_.value();
  s.time_reversed = time_reversed_.value();
  s.realigned = realigned_.value();
  s.last_error_ns = last_error_ns_.load(std::memory_order_relaxed);
  return s;
}

std::optional<std::int64_t> StereoSync::take_worst_error_ns() {
  const std::int64_t worst = worst_error_ns_.exchange(kNoPair, std::memory_order_relaxed);
  return worst == kNoPair ? std::nullopt : std::optional(worst);
}

void StereoSync::Side::drop_oldest() {
  std::move(waiting.begin() + 1, waiting.begin() + static_cast<std::ptrdiff_t>(count), waiting.begin());
  waiting[--count].release();
}

StereoPair StereoSync::newest_of_device() {
  StereoPair pair;
  FrameLease frame = left_.ring->oldest();
  if (!frame) return pair;
  for (FrameLease newer = left_.ring->oldest(); newer; newer = left_.ring->oldest()) {
    superseded_.add();
    frame = std::move(newer);
  }
  pair.seq = frame->seq;
  pair.capture_time = frame->mid_exposure;
  pair.arrival = frame->arrival;
  pair.first = std::move(frame);
  return pair;
}

StereoPair StereoSync::newest_of_waiting() {
  StereoPair best;
  // In rounds: after a stall of the consumer the rings hold more than can wait.
  for (bool more = true; more;) {
    const bool more_left = collect(left_);
    const bool more_right = collect(right_);
    more = more_left || more_right;
    while (left_.count > 0 && right_.count > 0) match_heads(best);
  }
  return best;
}

// True when it took a frame from the ring.
bool StereoSync::collect(Side& side) {
  const Side& other = &side == &left_ ? right_ : left_;
  bool took = false;
  while (side.ring->has_frame()) {
    if (side.count == kWaiting) {
      if (other.count > 0 || other.ring->has_frame()) return took;  // their partners are on the way
      side.drop_oldest();
      side.unpaired.add();
    }
    FrameLease frame = side.ring->oldest();
    // A camera's time that goes back leaves frames of the future behind, which would block all that follow.
    while (side.count > 0 && side.waiting[side.count - 1]->mid_exposure >= frame->mid_exposure) {
      time_reversed_.add();
      side.waiting[--side.count].release();
    }
    side.waiting[side.count++] = std::move(frame);
    took = true;
  }
  return took;
}

// Positive: the left head is the later one. In the unit of pairing: exposures or nanoseconds; 0 = a pair.
std::int64_t StereoSync::lead_of_left() const {
  const FrameLease& left = left_.waiting[0];
  const FrameLease& right = right_.waiting[0];
  if (config_.pair_by == PairBy::sequence && offset_known_) {
    return static_cast<std::int64_t>(left->seq - right->seq) - offset_;
  }
  const std::int64_t error = error_ns(left, right);
  return std::abs(error) <= tolerance_ns_ ? 0 : -error;
}

// Of two candidates within the tolerance the nearer one is the partner.
bool StereoSync::better_partner_behind() const {
  const std::int64_t error = std::abs(error_ns(left_.waiting[0], right_.waiting[0]));
  return (right_.count > 1 && std::abs(error_ns(left_.waiting[0], right_.waiting[1])) < error) ||
         (left_.count > 1 && std::abs(error_ns(left_.waiting[1], right_.waiting[0])) < error);
}

void StereoSync::match_heads(StereoPair& best) {
  const std::int64_t lead = lead_of_left();
  if (lead > 0) return drop_unmatched(right_);
  if (lead < 0) return drop_unmatched(left_);
  const std::int64_t error = error_ns(left_.waiting[0], right_.waiting[0]);
  const bool by_count = config_.pair_by == PairBy::sequence && offset_known_;
  if (by_count && std::abs(error) > tolerance_ns_) {
    out_of_tolerance_.add();
    drop_unmatched(left_);
    return drop_unmatched(right_);
  }
  if (!by_count && better_partner_behind()) return drop_unmatched(error < 0 ? right_ : left_);
  take_heads(best);
}

void StereoSync::drop_unmatched(Side& side) {
  side.drop_oldest();
  side.unpaired.add();
  if (++unmatched_in_row_ >= kUnmatchedUntilRealigned) offset_known_ = false;
}

void StereoSync::take_heads(StereoPair& best) {
  if (best) superseded_.add();
  best = StereoPair{};
  best.first = std::move(left_.waiting[0]);
  best.second = std::move(right_.waiting[0]);
  left_.drop_oldest();
  right_.drop_oldest();
  best.seq = best.first->seq;
  best.sync_error = best.second->mid_exposure - best.first->mid_exposure;
  best.capture_time = best.first->mid_exposure + best.sync_error / 2;
  best.arrival = std::max(best.first->arrival, best.second->arrival);
  unmatched_in_row_ = 0;
  if (config_.pair_by == PairBy::time || offset_known_) return;
  offset_ = static_cast<std::int64_t>(best.first->seq - best.second->seq);
  offset_known_ = true;
  realigned_.add();
}

void StereoSync::wait_for_frames(Duration timeout) {
  std::array<pollfd, 2> wakes{pollfd{left_.ring->wake_fd(), POLLIN, 0}, pollfd{-1, POLLIN, 0}};
  if (right_.ring != nullptr) wakes[1].fd = right_.ring->wake_fd();
  const timespec limit{static_cast<time_t>(timeout.count() / 1'000'000'000),
                       static_cast<long>(timeout.count() % 1'000'000'000)};
  if (::ppoll(wakes.data(), wakes.size(), &limit, nullptr) <= 0) return;
  if (wakes[0].revents != 0) left_.ring->clear_wake();
  if (wakes[1].revents != 0) right_.ring->clear_wake();
}

void StereoSync::note_delivered(const StereoPair& pair) {
  pairs_.add();
  const std::int64_t error = pair.sync_error.count();
  last_error_ns_.store(error, std::memory_order_relaxed);
  // Tried again when the reader takes it in between: then this pair belongs to the next report.
  std::int64_t worst = worst_error_ns_.load(std::memory_order_relaxed);
  while ((worst == kNoPair || std::abs(error) > std::abs(worst)) &&
         !worst_error_ns_.compare_exchange_weak(worst, error, std::memory_order_relaxed)) {
  }
}

}  // namespace pelorus
