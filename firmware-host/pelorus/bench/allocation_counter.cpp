#include "firmware-host/pelorus/bench/allocation_counter.h"

#include <atomic>
#include <cerrno>
#include <cstddef>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PELORUS_COUNTS_ALLOCATIONS 1
#else
#define PELORUS_COUNTS_ALLOCATIONS 0
#endif

namespace pelorus {
namespace {

constinit std::atomic<std::uint64_t> allocations{0};
constinit thread_local bool counted = false;

}  // namespace

bool allocations_are_counted() { return PELORUS_COUNTS_ALLOCATIONS != 0; }
void count_allocations_of_this_thread() { counted = true; }
std::uint64_t counted_allocations() { return allocations.load(std::memory_order_relaxed); }

#if PELORUS_COUNTS_ALLOCATIONS
namespace {

void note() {
  if (counted) allocations.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace
#endif

}  // namespace pelorus

#if PELORUS_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t bytes) noexcept {
  pelorus::note();
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) noexcept {
  pelorus::note();
  return __libc_calloc(count, bytes);
}
void* realloc(void* old, std::size_t bytes) noexcept {
  pelorus::note();
  return __libc_realloc(old, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  pelorus::note();
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  pelorus::note();
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t bytes) noexcept {
  pelorus::note();
  *out = __libc_memalign(alignment, bytes);
  return *out != nullptr ? 0 : ENOMEM;
}
}
#endif
