#pragma once
// The computer's time: whether something keeps it right, and whether reading it is cheap and steady. Reads the kernel.

#include <string>

#include "firmware-host/pelorus/doctor/host_check.h"
#include "firmware-host/pelorus/doctor/host_files.h"

namespace pelorus {

// What adjtimex(2) says.
struct ClockDiscipline {
  bool known = false;
  bool synchronized = false;
  double largest_error_s = 0;
  int year = 0;  // UTC
};

[[nodiscard]] ClockDiscipline read_clock_discipline();
[[nodiscard]] HostCheck judge_clock(const ClockDiscipline& clock, bool cameras_by_ptp);
[[nodiscard]] HostCheck check_clock_source(const HostFiles& files);

}  // namespace pelorus
