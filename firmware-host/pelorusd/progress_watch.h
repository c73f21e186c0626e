#pragma once
// ProgressWatch: whether every part of the service still moves; the watchdog is fed by this and by nothing else. A part
// is a counter that must change within a time. Thread-bound to the main thread.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pelorus {

class ProgressWatch {
 public:
  using Clock = std::chrono::steady_clock;
  explicit ProgressWatch(std::chrono::milliseconds longest_standstill) : longest_(longest_standstill) {}

  // The present count of a part; `excused`: it may stand still now (a camera that is being searched for). A part may
  // have a limit of its own.
  void look(const std::string& part, std::uint64_t count, bool excused, Clock::time_point now,
            std::optional<std::chrono::milliseconds> longest_standstill = {});
  // The first part that stands still for too long; empty when all move.
  [[nodiscard]] std::string stuck(Clock::time_point now) const;

 private:
  struct Part {
    std::string name;
    std::uint64_t count = 0;
    Clock::time_point moved;
    std::chrono::milliseconds longest;
  };
  std::chrono::milliseconds longest_;
  std::vector<Part> parts_;
};

}  // namespace pelorus
