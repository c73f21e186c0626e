#pragma once
// FrameRing: frames from a capture thread to their consumer without lock, wait or allocation. A fixed pool of slots
// and two index rings, free and ready. The camera never waits for the consumer: when no slot is free the new frame is
// dropped; the consumer takes the newest and gives the older ones back. Every drop is counted with its cause.
// Thread-safe for one producer (slot, publish) and one consumer (wait, newest, oldest, leases); drops() for all.

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/counter.h"
#include "core/base/spsc_ring.h"
#include "drivers/camera_frame.h"
#include "drivers/unique_fd.h"

namespace pelorus {

class FrameRing;

// Permission to read a slot; gives it back when destroyed (on the consumer's thread). The ring outlives its leases.
class FrameLease {
 public:
  FrameLease() = default;
  FrameLease(FrameLease&& other) noexcept : ring_(std::exchange(other.ring_, nullptr)), slot_(other.slot_) {}
  FrameLease& operator=(FrameLease&& other) noexcept;
  ~FrameLease() { release(); }

  explicit operator bool() const { return ring_ != nullptr; }
  [[nodiscard]] const CameraFrame& operator*() const;
  [[nodiscard]] const CameraFrame* operator->() const { return &**this; }
  void release();

 private:
  friend class FrameRing;
  FrameLease(FrameRing* ring, std::uint32_t slot) : ring_(ring), slot_(slot) {}

  FrameRing* ring_ = nullptr;
  std::uint32_t slot_ = 0;
};

struct RingDrops {
  std::uint64_t no_free_slot = 0;  // new frames dropped: the consumer held all the others
  std::uint64_t superseded = 0;    // frames given back unread because a newer one was there
};

class FrameRing {
 public:
  // At least 3 slots: one being filled, one ready, one being read. The consumer may hold slots - 2 without loss.
  // Frames of another format are taken too, at the price of an allocation in their slot.
  FrameRing(int slots, const FrameFormat& format);

  // Producer: the slot to fill next; there always is one.
  [[nodiscard]] CameraFrame& slot() { return slots_[filling_]; }
  // Producer: hands the filled slot on. False: no other slot is free, so this frame is dropped and counted.
  bool publish();

  // Consumer: the newest frame, older ones are given back and counted; empty lease when there is none.
  [[nodiscard]] FrameLease newest();
  // Consumer: the frame that waits longest, for those who want every frame.
  [[nodiscard]] FrameLease oldest();
  [[nodiscard]] bool has_frame() const { return !ready_.empty(); }
  // Consumer: waits until a frame is ready, at most `timeout`. True when there is one.
  [[nodiscard]] bool wait(Duration timeout);
  // Consumer: becomes readable when a frame was published; for waiting on several rings at once.
  [[nodiscard]] int wake_fd() const { return wake_.get(); }
  // Consumer: makes wake_fd() unreadable until the next frame; look for frames afterwards.
  void clear_wake();

  [[nodiscard]] RingDrops drops() const { return {no_free_slot_.value(), superseded_.value()}; }
  [[nodiscard]] int slot_count() const { return static_cast<int>(slots_.size()); }

 private:
  friend class FrameLease;
  void give_back(std::uint32_t slot);

  std::vector<CameraFrame> slots_;
  SpscRing<std::uint32_t> free_;   // consumer to producer
  SpscRing<std::uint32_t> ready_;  // producer to consumer
  std::uint32_t filling_ = 0;      // producer's
  UniqueFd wake_;
  Counter no_free_slot_;
  Counter superseded_;
};

}  // namespace pelorus
