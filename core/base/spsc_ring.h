#pragma once
// SpscRing<T>: bounded queue between one producer and one consumer thread, without lock or wait (Lamport 1983, with
// each side keeping a copy of the other's index so that it is read only when the ring looks full or empty).
// Thread-safe for exactly one producer (try_push) and one consumer (try_pop, empty). O(1); allocates at construction.

#include <atomic>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <vector>

#include "core/base/check.h"

namespace pelorus {

template <class T>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>, "slots are copied while the other side runs");

 public:
  explicit SpscRing(std::size_t capacity) : slots_(capacity + 1) {
    PELORUS_CHECK(capacity > 0, "a ring holds at least one element");
  }
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  // Producer. False: full, nothing changed.
  [[nodiscard]] bool try_push(const T& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = after(tail);
    if (next == head_seen_) {
      head_seen_ = head_.load(std::memory_order_acquire);
      if (next == head_seen_) return false;
    }
    slots_[tail] = value;
    tail_.store(next, std::memory_order_release);
    return true;
  }

  // Consumer. Empty: nothing there.
  [[nodiscard]] std::optional<T> try_pop() {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_seen_) {
      tail_seen_ = tail_.load(std::memory_order_acquire);
      if (head == tail_seen_) return std::nullopt;
    }
    const T value = slots_[head];
    head_.store(after(head), std::memory_order_release);
    return value;
  }

  // Consumer.
  [[nodiscard]] bool empty() const {
    return head_.load(std::memory_order_relaxed) == tail_.load(std::memory_order_acquire);
  }

  [[nodiscard]] std::size_t capacity() const { return slots_.size() - 1; }

 private:
  [[nodiscard]] std::size_t after(std::size_t index) const { return index + 1 == slots_.size() ? 0 : index + 1; }

  static constexpr std::size_t kCacheLine = 64;  // each side writes to lines of its own
  std::vector<T> slots_;                         // one always empty: full and empty differ
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  std::size_t tail_seen_ = 0;  // consumer's
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
  std::size_t head_seen_ = 0;  // producer's
};

}  // namespace pelorus
