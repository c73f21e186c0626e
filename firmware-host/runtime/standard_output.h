#pragma once
// The end of what a program prints. Output is buffered: a disk that is full shows only when the last of it is written,
// which the C library does at exit without telling anybody. Main thread.

#include "core/base/result.h"

namespace pelorus {

// Everything printed so far has been taken, or io: some of it is lost.
[[nodiscard]] Result<> flush_standard_output();

}  // namespace pelorus
