#include "firmware-host/runtime/process_setup.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>

namespace pelorus {
namespace {

constexpr int kHighPriority = 40;
constexpr int kReleasePriority = 35;
constexpr int kMiddlePriority = 30;
constexpr int kLowPriority = 20;
constexpr int kBehindPriority = 10;
constexpr int kBackgroundNice = 10;
constexpr std::size_t kTouchedStack = 512 * 1024;

// Touches the stack that a real-time thread will use, so that no page of it has to be found later.
void touch_stack() {
  volatile char stack[kTouchedStack];
  for (std::size_t i = 0; i < sizeof stack; i += 4096) stack[i] = 0;
}

// Named by the first processor on it; where the kernel does not tell, each processor is a core.
int physical_core(int processor) {
  std::ifstream siblings("/sys/devices/system/cpu/cpu" + std::to_string(processor) + "/topology/thread_siblings_list");
  int first = processor;
  return siblings >> first ? first : processor;
}

}  // namespace

std::string lock_memory() {
  rlimit limit{};
  ::getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur != RLIM_INFINITY && ::geteuid() != 0) {
    return "the limit of locked memory is " + std::to_string(limit.rlim_cur >> 10) + " kB (LimitMEMLOCK=infinity)";
  }
  // On fault: what was touched stays. All at once would also load 200 MB of libraries that the picture decoders'
  // package brings and nobody calls (321 MB resident in place of 122 MB).
  if (::mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0) return "";
  return std::strerror(errno);
}

std::vector<int> binding_order(std::span<const int> processors, const std::function<int(int)>& core_of) {
  std::vector<int> first_of_core;
  std::vector<int> siblings;
  std::set<int> taken;
  for (auto processor = processors.rbegin(); processor != processors.rend(); ++processor) {
    (taken.insert(core_of(*processor)).second ? first_of_core : siblings).push_back(*processor);
  }
  first_of_core.insert(first_of_core.end(), siblings.begin(), siblings.end());
  return first_of_core;
}

int processor_to_bind(int n) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) == 0) return kAnyProcessor;
  std::vector<int> processors;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(cpu, &allowed)) processors.push_back(cpu);
  }
  return binding_order(processors, physical_core)[static_cast<std::size_t>(n) % processors.size()];
}

std::string set_thread(const char* name, ThreadClass wanted, int processor) {
  ::pthread_setname_np(::pthread_self(), name);
  int unpinned = 0;  // a thread that may not be pinned is still worth its class
  if (processor != kAnyProcessor) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    unpinned = ::pthread_setaffinity_np(::pthread_self(), sizeof one, &one);
  }
  const std::string pin_refusal = unpinned == 0 ? "" : std::strerror(unpinned);
  if (wanted == ThreadClass::normal) return pin_refusal;
  if (wanted == ThreadClass::background) {
    // On Linux the nice value is the thread's own.
    return ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kBackgroundNice) == 0 ? "" : std::strerror(errno);
  }
  touch_stack();
  sched_param parameters{};
  parameters.sched_priority = wanted == ThreadClass::fifo_high      ? kHighPriority
                              : wanted == ThreadClass::fifo_release ? kReleasePriority
                              : wanted == ThreadClass::fifo_middle  ? kMiddlePriority
                              : wanted == ThreadClass::fifo_low     ? kLowPriority
                                                                    : kBehindPriority;
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
  return error == 0 ? pin_refusal : std::strerror(error);
}

std::string pin_refusal() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0) return std::strerror(errno);
  return ::sched_setaffinity(0, sizeof allowed, &allowed) == 0 ? "" : std::strerror(errno);
}

std::string realtime_refusal() {
  sched_param before{};
  int policy = 0;
  ::pthread_getschedparam(::pthread_self(), &policy, &before);
  sched_param wanted{};
  wanted.sched_priority = kHighPriority;
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &wanted);
  if (error != 0) return std::string(std::strerror(error)) + " (LimitRTPRIO=50)";
  ::pthread_setschedparam(::pthread_self(), policy, &before);
  return "";
}

}  // namespace pelorus
