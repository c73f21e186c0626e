#include "firmware-host/pelorus/doctor/scheduling.h"

#include <linux/capability.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <thread>

#include "core/base/nearest_rank.h"
#include "firmware-host/runtime/process_setup.h"

namespace pelorus {
namespace {

constexpr double kGoodDelay_us = 1000;
constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t now_ns() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * kSecond_ns + t.tv_nsec;
}

void wake_up_repeatedly(std::chrono::milliseconds length, std::chrono::microseconds period, WakeupDelays& delays) {
  delays.refusal = set_thread("wakeups", ThreadClass::fifo_high);
  delays.realtime = delays.refusal.empty();
  const std::int64_t step_ns = std::chrono::nanoseconds(period).count();
  const std::int64_t end_ns = now_ns() + std::chrono::nanoseconds(length).count();
  for (std::int64_t due_ns = now_ns() + step_ns; due_ns < end_ns;) {
    const timespec due{due_ns / kSecond_ns, due_ns % kSecond_ns};
    if (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) != 0) continue;  // a signal: sleep on
    const std::int64_t awake_ns = now_ns();
    delays.late_us.push_back(1e-3 * static_cast<double>(awake_ns - due_ns));
    // Wake-ups that were slept over are part of the delay measured just now, not delays of their own.
    due_ns += step_ns * std::max<std::int64_t>(1, (awake_ns - due_ns) / step_ns + 1);
  }
  std::sort(delays.late_us.begin(), delays.late_us.end());
}

}  // namespace

double WakeupDelays::percentile_us(double share) const { return nearest_rank(late_us, share); }

WakeupDelays measure_wakeups(std::chrono::milliseconds length, std::chrono::microseconds period) {
  WakeupDelays delays;
  delays.late_us.reserve(static_cast<std::size_t>(length / period) + 1);
  std::thread([&] { wake_up_repeatedly(length, period, delays); }).join();
  return delays;
}

HostCheck judge_wakeups(const WakeupDelays& delays, const TimingConfig& timing, const std::string& kernel) {
  HostCheck check{Verdict::ok, "scheduling latency", "", ""};
  if (delays.late_us.empty()) {
    check.verdict = Verdict::fail;
    check.found = "no timer fired: the machine stands still";
    check.cure = "look for what takes all processors (top)";
    return check;
  }
  const double p99_us = delays.percentile_us(0.99), max_us = delays.late_us.back();
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "%zu wake-ups %s: p50 %.0f us, p99 %.0f us, max %.0f us; kernel %s",
                delays.late_us.size(), delays.realtime ? "in real time" : "without real-time priority",
                delays.percentile_us(0.5), p99_us, max_us, kernel.c_str());
  check.found = text.data();
  if (max_us <= kGoodDelay_us) return check;
  check.verdict = p99_us > 1e3 * timing.deadline_tolerance_ms ? Verdict::fail : Verdict::warn;
  check.cure = delays.realtime
                   ? "stop other work on this computer; a kernel with PREEMPT_RT; governor performance; idle "
                     "states off in the firmware"
                   : "measure with real-time priority, as the service runs (as root, or ulimit -r 50); stop "
                     "other work on this computer";
  return check;
}

std::string kernel_text(const HostFiles& files) {
  const std::string release = files.text("/proc/sys/kernel/osrelease").value_or("unknown");
  const std::string version = files.text("/proc/version").value_or("");
  const bool realtime =
      files.number("/sys/kernel/realtime").value_or(0) == 1 || version.find("PREEMPT_RT") != std::string::npos;
  return release + (realtime ? " (PREEMPT_RT)" : "");
}

HostCheck judge_realtime(bool wanted, const std::string& refusal, const std::optional<UnitLimits>& unit,
                         const HostFiles& files) {
  HostCheck check{Verdict::ok, "real-time priority", "", ""};
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  const std::string limits = "RLIMIT_RTPRIO " +
                             (limit.rlim_cur == RLIM_INFINITY ? "unlimited" : std::to_string(limit.rlim_cur)) +
                             (holds_capability(files, CAP_SYS_NICE) ? ", CAP_SYS_NICE" : ", no CAP_SYS_NICE");
  const auto share_us = files.number("/proc/sys/kernel/sched_rt_runtime_us");
  if (!wanted) {
    check.found = "not asked for (process.realtime: false)";
  } else if (share_us && *share_us == 0) {
    check.verdict = Verdict::fail;
    check.found = "kernel.sched_rt_runtime_us is 0: real-time threads never run";
    check.cure = "sysctl -w kernel.sched_rt_runtime_us=950000 (systemd/60-pelorus.conf)";
  } else if (refusal.empty()) {
    check.found = "granted (" + limits + ")";
  } else if (unit && unit->grants_realtime()) {
    check.found =
        "not for this shell (" + limits + "), but the unit grants it: LimitRTPRIO=" + unit->value("LimitRTPRIO");
  } else {
    check.verdict = Verdict::warn;
    check.found = "refused: " + refusal + "; " + limits;
    check.cure = "run the service by its unit (LimitRTPRIO=50), or: ulimit -r 50 by /etc/security/limits.d";
  }
  return check;
}

HostCheck judge_memory_lock(bool wanted, const std::string& refusal, const std::optional<UnitLimits>& unit) {
  HostCheck check{Verdict::ok, "locked memory", "", ""};
  if (!wanted) {
    check.found = "not asked for (process.lock_memory: false)";
  } else if (refusal.empty()) {
    check.found = "granted";
  } else if (unit && unit->grants_locked_memory()) {
    check.found = "not for this shell (" + refusal + "), but the unit grants it: LimitMEMLOCK=infinity";
  } else {
    check.verdict = Verdict::warn;
    check.found = "refused: " + refusal;
    check.cure =
        "run the service by its unit (LimitMEMLOCK=infinity), or: ulimit -l unlimited by /etc/security/limits.d";
  }
  return check;
}

HostCheck check_governor(const HostFiles& files) {
  HostCheck check{Verdict::ok, "CPU governor", "", ""};
  std::map<std::string, int> processors;
  for (const std::string& cpu : files.entries("/sys/devices/system/cpu")) {
    if (const auto governor = files.text(cpu + "/cpufreq/scaling_governor")) ++processors[*governor];
  }
  if (processors.empty()) {
    check.found = "no frequency scaling by the kernel (fixed, or a virtual machine)";
    return check;
  }
  for (const auto& [governor, how_many] : processors) {
    check.found += (check.found.empty() ? "" : ", ") + governor + " on " + std::to_string(how_many) + " processor(s)";
  }
  if (processors.size() == 1 && processors.contains("performance")) return check;
  check.verdict = Verdict::warn;
  check.cure = "cpupower frequency-set -g performance: the first pictures after a quiet time come late otherwise";
  return check;
}

}  // namespace pelorus
