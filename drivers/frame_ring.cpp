#include "drivers/frame_ring.h"

#include <poll.h>
#include <sys/eventfd.h>

#include <chrono>
#include <optional>

namespace pelorus {

FrameLease& FrameLease::operator=(FrameLease&& other) noexcept {
  if (this == &other) return *this;
  release();
  ring_ = std::exchange(other.ring_, nullptr);
  slot_ = other.slot_;
  return *this;
}

const CameraFrame& FrameLease::operator*() const {
  PELORUS_CHECK(ring_ != nullptr, "an empty lease has no frame");
  return ring_->slots_[slot_];
}

void FrameLease::release() {
  if (ring_ != nullptr) std::exchange(ring_, nullptr)->give_back(slot_);
}

FrameRing::FrameRing(int slots, const FrameFormat& format)
    : slots_(static_cast<std::size_t>(slots)),
      free_(slots_.size()),
      ready_(slots_.size()),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  PELORUS_CHECK(slots >= 3, "a frame ring needs a slot to fill, one ready and one to read");
  PELORUS_CHECK(static_cast<bool>(wake_), "no event descriptor for a frame ring");
  for (CameraFrame& frame : slots_) frame.resize(format);
  for (std::uint32_t i = 1; i < slots_.size(); ++i) give_back(i);
}

bool FrameRing::publish() {
  const std::optional<std::uint32_t> next = free_.try_pop();
  if (!next) {
    no_free_slot_.add();
    return false;
  }
  PELORUS_CHECK(ready_.try_push(filling_), "a ring of all slots cannot be full");
  filling_ = *next;
  const std::uint64_t one = 1;
  // Fails only when the counter is at its limit, and then the descriptor is readable already.
  [[maybe_unused]] const ssize_t written = ::write(wake_.get(), &one, sizeof one);
  return true;
}

FrameLease FrameRing::newest() {
  FrameLease lease = oldest();
  while (lease) {
    FrameLease newer = oldest();
    if (!newer) break;
    superseded_.add();
    lease = std::move(newer);
  }
  return lease;
}

FrameLease FrameRing::oldest() {
  const std::optional<std::uint32_t> slot = ready_.try_pop();
  return slot ? FrameLease(this, *slot) : FrameLease();
}

bool FrameRing::wait(Duration timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  // The descriptor may still tell of a frame that was taken already: then it is waited on.
  while (!has_frame()) {
    const Duration left = deadline - std::chrono::steady_clock::now();
    if (left <= Duration::zero()) return false;
    pollfd wake{wake_.get(), POLLIN, 0};
    const timespec limit{static_cast<time_t>(left.count() / 1'000'000'000),
                         static_cast<long>(left.count() % 1'000'000'000)};
    if (::ppoll(&wake, 1, &limit, nullptr) > 0) clear_wake();
  }
  return true;
}

void FrameRing::clear_wake() {
  std::uint64_t published = 0;
  [[maybe_unused]] const ssize_t got = ::read(wake_.get(), &published, sizeof published);
}

void FrameRing::give_back(std::uint32_t slot) {
  PELORUS_CHECK(free_.try_push(slot), "a ring of all slots cannot be full");
}

}  // namespace pelorus
