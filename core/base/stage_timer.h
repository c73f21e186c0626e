#pragma once
// The one clock that core reads: wall time of a stage, for the report only; no result depends on it. Pure use:
//   { StageTimer timer(report[Stage::ego_motion].microseconds); ... }

#include <chrono>
#include <cstdint>

namespace pelorus {

class StageTimer {
 public:
  explicit StageTimer(std::int32_t& microseconds) : microseconds_(microseconds), start_(Clock::now()) {}
  ~StageTimer() {
    const auto spent = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start_);
    microseconds_ += static_cast<std::int32_t>(spent.count());
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  std::int32_t& microseconds_;
  Clock::time_point start_;
};

}  // namespace pelorus
