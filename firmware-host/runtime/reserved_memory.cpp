#include "firmware-host/runtime/reserved_memory.h"

#include <sys/mman.h>

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

}  // namespace

std::string populate_reserved_memory() {
  std::ifstream maps("/proc/self/maps");
  Mapping before;
  Mapping here;
  for (std::string line; std::getline(maps, line); before = here) {
    if (!read(line, here)) continue;
    const bool reserved = here.access == "rw-p" && (here.name.empty() || here.name == "[heap]");
    const bool is_stack = before.access == "---p" && before.end == here.begin;  // above its guard
    if (!reserved || is_stack) continue;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the kernel tells addresses as numbers
    if (::madvise(reinterpret_cast<void*>(here.begin), here.end - here.begin, MADV_POPULATE_WRITE) != 0) {
      return std::string("memory cannot be populated: ") + std::strerror(errno);
    }
  }
  return "";
}

}  // namespace pelorus
