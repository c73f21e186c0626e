#pragma once
// HostFacts: what this process takes of the computer and how the computer is, read from the kernel once a second.
// Whatever cannot be read is NaN. Thread-bound.

#include <chrono>
#include <string>

#include "services/health_report.h"

namespace pelorus {

class HostFacts {
 public:
  // `disk_folder`: where the free space is of interest; empty = not looked at.
  explicit HostFacts(std::string disk_folder);
  // CPU share since the last call.
  [[nodiscard]] HostReport read();

 private:
  std::string disk_folder_;
  std::chrono::steady_clock::time_point last_;
  double last_cpu_s_ = 0;
};

}  // namespace pelorus
