#include "firmware-host/runtime/reserved_memory.h"

#include <pthread.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#ifndef MADV_POPULATE_WRITE
#define MADV_POPULATE_WRITE 23  // Linux 5.14
#endif

namespace pelorus {
namespace {

// A line of /proc/self/maps (proc(5)).
struct Mapping {
  std::uintptr_t begin = 0;
  std::uintptr_t end = 0;
  std::string access;
  std::string name;
};

bool read(const std::string& line, Mapping& mapping) {
  std::istringstream fields(line);
  char dash = 0;
  std::string offset;
  std::string device;
  std::string inode;
  mapping.name.clear();
  if (!(fields >> std::hex >> mapping.begin >> dash >> mapping.end >> mapping.access >> offset >> device >> inode)) {
    return false;
  }
  fields >> mapping.name;
  return true;
}

// What a thread's stack may take; set_thread() touches what it will.
std::size_t stack_bytes() {
  pthread_attr_t attributes;
  std::size_t bytes = 0;
  if (::pthread_getattr_default_np(&attributes) != 0) return bytes;
  ::pthread_attr_getstacksize(&attributes, &bytes);
  ::pthread_attr_destroy(&attributes);
  return bytes;
}

}  // namespace

std::string populate_reserved_memory() {
  std::ifstream maps("/proc/self/maps");
  const std::size_t stack = stack_bytes();
  int refusal = 0;
  Mapping before;
  Mapping here;
  for (std::string line; std::getline(maps, line); before = here) {
    if (!read(line, here)) continue;
    if (here.access != "rw-p" || !(here.name.empty() || here.name == "[heap]")) continue;
    // Above its guard a stack begins; kernels before 6.7 show what lies above it as one mapping with it.
    const bool guarded = before.access == "---p" && before.end == here.begin;
    const std::uintptr_t begin = guarded ? std::min(here.begin + stack, here.end) : here.begin;
    if (begin == here.end) continue;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the kernel tells addresses as numbers
    if (::madvise(reinterpret_cast<void*>(begin), here.end - begin, MADV_POPULATE_WRITE) != 0) refusal = errno;
  }
  return refusal == 0 ? "" : std::strerror(refusal);
}

}  // namespace pelorus
