#pragma once
// Counts the heap allocations of chosen threads, all libraries included, by standing in front of glibc's allocator in
// this program. Not available under sanitizers, which bring an allocator of their own. Thread-safe.

#include <cstdint>

namespace pelorus {

[[nodiscard]] bool allocations_are_counted();
// From now on the calling thread is counted.
void count_allocations_of_this_thread();
[[nodiscard]] std::uint64_t counted_allocations();

}  // namespace pelorus
