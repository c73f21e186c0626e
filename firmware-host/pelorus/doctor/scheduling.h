#pragma once
// How well the kernel wakes a thread at its time, and what may make it worse: real-time privilege, memory that can be
// swapped out, processors that sleep or slow down. Thread rule: measure_wakeups() starts a thread of its own and waits
// for it; the rest reads files or is pure.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "firmware-host/pelorus/doctor/host_check.h"
#include "firmware-host/pelorus/doctor/host_files.h"
#include "firmware-host/pelorus/doctor/unit_limits.h"
#include "services/service_settings.h"

namespace pelorus {

struct WakeupDelays {
  std::vector<double> late_us;  // of every wake-up of a timer, sorted
  bool realtime = false;        // measured with the scheduling class of the capture threads
  std::string refusal;          // why not

  [[nodiscard]] double percentile_us(double share) const;  // NaN when nothing was measured
};

// A timer of `period` for `length`, as cyclictest(8) does.
[[nodiscard]] WakeupDelays measure_wakeups(std::chrono::milliseconds length, std::chrono::microseconds period);

// OK up to 1 ms, which is the jitter that a release may have; FAIL when one wake-up in a hundred alone uses up the
// tolerance of the deadline.
[[nodiscard]] HostCheck judge_wakeups(const WakeupDelays& delays, const TimingConfig& timing,
                                      const std::string& kernel);

// "6.1.0-18-rt-amd64, preemption: real time".
[[nodiscard]] std::string kernel_text(const HostFiles& files);

// `refusal`: empty when this process was granted the class; see realtime_refusal().
[[nodiscard]] HostCheck judge_realtime(bool wanted, const std::string& refusal, const std::optional<UnitLimits>& unit,
                                       const HostFiles& files);
[[nodiscard]] HostCheck judge_memory_lock(bool wanted, const std::string& refusal,
                                          const std::optional<UnitLimits>& unit);
[[nodiscard]] HostCheck check_governor(const HostFiles& files);

}  // namespace pelorus
