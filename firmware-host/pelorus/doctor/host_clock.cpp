#include "firmware-host/pelorus/doctor/host_clock.h"

#include <sys/timex.h>
#include <time.h>

#include <array>
#include <cstdio>

namespace pelorus {
namespace {
constexpr int kYearOfNoBattery = 2024;  // before: the clock started at the epoch and nobody set it
}

ClockDiscipline read_clock_discipline() {
  timex kernel{};
  ClockDiscipline clock;
  const int state = ::adjtimex(&kernel);
  clock.known = state >= 0;
  clock.synchronized = clock.known && state != TIME_ERROR && (kernel.status & STA_UNSYNC) == 0;
  clock.largest_error_s = 1e-6 * static_cast<double>(kernel.maxerror);
  const time_t now = ::time(nullptr);
  tm utc{};
  ::gmtime_r(&now, &utc);
  clock.year = utc.tm_year + 1900;
  return clock;
}

HostCheck judge_clock(const ClockDiscipline& clock, bool cameras_by_ptp) {
  HostCheck check{Verdict::ok, "clock", "", ""};
  if (clock.year < kYearOfNoBattery) {
    check.verdict = Verdict::fail;
    check.found = "says it is " + std::to_string(clock.year);
    check.cure = "set it (date -u -s ..., hwclock --systohc); change the battery of the clock";
  } else if (!clock.known || !clock.synchronized) {
    check.verdict = Verdict::warn;
    check.found = clock.known ? "not synchronized" : "the kernel does not tell whether it is synchronized";
    if (cameras_by_ptp) check.found += ", and camera.clock is ptp";
    check.cure = cameras_by_ptp
                     ? "run ptp4l and phc2sys"
                     : "chrony or ptp4l before the dive, or recordings will not match those of other computers";
  } else {
    std::array<char, 80> text{};
    std::snprintf(text.data(), text.size(), "synchronized, error at most %.3f s", clock.largest_error_s);
    check.found = text.data();
  }
  return check;
}

HostCheck check_clock_source(const HostFiles& files) {
  HostCheck check{Verdict::ok, "clock source", "", ""};
  const auto source = files.text("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  check.found = source.value_or("not told by the kernel");
  if (source == "hpet" || source == "acpi_pm" || source == "jiffies" || source == "refined-jiffies") {
    check.verdict = Verdict::warn;
    check.found += ": slow to read";
    check.cure = "find in dmesg why the kernel gave up tsc; tsc=reliable on the kernel's command line if it is";
  }
  return check;
}

}  // namespace pelorus
