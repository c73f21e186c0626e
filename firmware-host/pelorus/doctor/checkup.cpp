#include "firmware-host/pelorus/doctor/checkup.h"

#include <linux/capability.h>
#include <sys/mman.h>

#include "firmware-host/pelorus/doctor/can_bus.h"
#include "firmware-host/pelorus/doctor/host_clock.h"
#include "firmware-host/pelorus/doctor/network.h"
#include "firmware-host/pelorus/doctor/scheduling.h"
#include "firmware-host/pelorus/doctor/sources.h"
#include "firmware-host/pelorus/doctor/storage.h"
#include "firmware-host/pelorus/doctor/unit_limits.h"
#include "firmware-host/runtime/process_setup.h"

namespace pelorus {
namespace {

constexpr std::chrono::microseconds kTimerPeriod{1000};

// As the service would be answered; this program needs no locked memory itself.
std::string memory_lock_refusal() {
  std::string refusal = lock_memory();
  if (refusal.empty()) ::munlockall();
  return refusal;
}

}  // namespace

std::vector<HostCheck> check_host(const ServiceConfig& config, const HostFiles& files, const CheckupOptions& options) {
  std::vector<HostCheck> checks;
  const auto unit = read_unit(files);
  checks.push_back(judge_wakeups(measure_wakeups(options.timer_run, kTimerPeriod), config.timing, kernel_text(files)));
  checks.push_back(judge_realtime(config.process.realtime, realtime_refusal(), unit, files));
  checks.push_back(judge_memory_lock(config.process.lock_memory, memory_lock_refusal(), unit));
  checks.push_back(check_governor(files));

  const auto address = parse_lcm_url(config.lcm.url);
  const MulticastRoute route = address && config.lcm.enabled ? find_multicast_route(*address) : MulticastRoute{};
  checks.push_back(judge_lcm(config.lcm, address, route));
  checks.push_back(check_lcm_loopback(config.lcm, route));
  const bool raw_network = holds_capability(files, CAP_NET_RAW) || (unit && unit->grants_raw_network());
  checks.push_back(check_socket_buffers(files, config, raw_network));
  checks.push_back(judge_can(config.can, config.can.enabled ? read_can_link(config.can.interface) : CanLink{}));

  SourceFindings sources = check_sources(config, options.configured);
  checks.insert(checks.end(), sources.checks.begin(), sources.checks.end());
  checks.push_back(check_storage(config.recorder, sources.flow));
  checks.push_back(judge_clock(read_clock_discipline(), config.camera.clock == "ptp"));
  checks.push_back(check_clock_source(files));
  checks.push_back(check_unit(unit, config));
  return checks;
}

}  // namespace pelorus
