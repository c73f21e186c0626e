#pragma once
// Counter: events counted by one thread and read by others (health, reports). Thread-safe; orders nothing else.

#include <atomic>
#include <cstdint>

namespace pelorus {

class Counter {
 public:
  void add(std::uint64_t events = 1) { value_.fetch_add(events, std::memory_order_relaxed); }
  void set(std::uint64_t value) { value_.store(value, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

}  // namespace pelorus
