#include "services/host_facts.h"

#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace pelorus {
namespace {

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  if (!(file >> total >> resident)) return kUnknown;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double hottest_degc() {
  double hottest = kUnknown;
  std::error_code error;
  for (const auto& zone : std::filesystem::directory_iterator("/sys/class/thermal", error)) {
    std::ifstream file(zone.path() / "temp");
    double milli_degc = 0;
    if (file >> milli_degc) hottest = std::fmax(hottest, milli_degc * 1e-3);
  }
  return hottest;
}

// Of a folder that is yet to be made: where it will be.
double free_gb(const std::string& folder) {
  struct statvfs facts {};
  if (folder.empty()) return kUnknown;
  std::error_code error;
  std::filesystem::path place = std::filesystem::absolute(folder, error);
  while (place.has_relative_path() && !std::filesystem::exists(place, error)) place = place.parent_path();
  if (::statvfs(place.c_str(), &facts) != 0) return kUnknown;
  return static_cast<double>(facts.f_bavail) * static_cast<double>(facts.f_frsize) / 1e9;
}

}  // namespace

HostFacts::HostFacts(std::string disk_folder)
    : disk_folder_(std::move(disk_folder)), last_(std::chrono::steady_clock::now()), last_cpu_s_(process_cpu_s()) {}

HostReport HostFacts::read() {
  HostReport report;
  const auto now = std::chrono::steady_clock::now();
  const double cpu_s = process_cpu_s();
  const double elapsed_s = std::chrono::duration<double>(now - last_).count();
  if (elapsed_s > 0) report.cpu_percent = 100 * (cpu_s - last_cpu_s_) / elapsed_s;
  last_ = now;
  last_cpu_s_ = cpu_s;
  report.memory_mb = resident_mb();
  report.temperature_degc = hottest_degc();
  report.disk_free_gb = free_gb(disk_folder_);
  return report;
}

}  // namespace pelorus
