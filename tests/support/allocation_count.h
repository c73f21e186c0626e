#pragma once
// Counts heap allocations of the whole program, libraries included, by standing in front of glibc's allocator. Include
// in one source file of a test program. Not available under sanitizers, which bring an allocator of their own.

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PELORUS_COUNTS_ALLOCATIONS 1
#else
#define PELORUS_COUNTS_ALLOCATIONS 0
#endif

namespace pelorus::test {

inline std::atomic<long> allocations{0};

template <class F>
long allocations_in(F&& work) {
  const long before = allocations.load();
  work();
  return allocations.load() - before;
}

}  // namespace pelorus::test

#if PELORUS_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t bytes) noexcept {
  ++pelorus::test::allocations;
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) noexcept {
  ++pelorus::test::allocations;
  return __libc_calloc(count, bytes);
}
void* realloc(void* old, std::size_t bytes) noexcept {
  ++pelorus::test::allocations;
  return __libc_realloc(old, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  ++pelorus::test::allocations;
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  ++pelorus::test::allocations;
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t bytes) noexcept {
  ++pelorus::test::allocations;
  *out = __libc_memalign(alignment, bytes);
  return *out != nullptr ? 0 : ENOMEM;
}
}
#endif
