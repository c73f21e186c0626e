// Pages behind memory that was reserved and not written yet. Main thread, once everything is built.
#pragma once

#include <string>

namespace pelorus {

// Gives every page of the heap and of large allocations its memory now (madvise(2), MADV_POPULATE_WRITE), so that the
// first point beyond the most so far does not wait for one. Stacks are touched by set_thread(). Empty, or why some of
// it was refused: kernels before 5.14 know no such call. What is allocated later (a pipeline begun anew by a reset, the
// buffers of a camera that comes back) finds its pages at first use.
[[nodiscard]] std::string populate_reserved_memory();

}  // namespace pelorus
