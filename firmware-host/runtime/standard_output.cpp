#include "firmware-host/runtime/standard_output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace pelorus {

Result<> flush_standard_output() {
  const bool failed_before = std::ferror(stdout) != 0;  // errno has been used for other things since
  if (std::fflush(stdout) == 0 && !failed_before) return Ok{};
  const std::string reason = failed_before ? "" : std::string(": ") + std::strerror(errno);
  return Error{ErrorCode::io, "standard output", "cannot be written, what was printed is not whole" + reason,
               "free space where it is led to"};
}

}  // namespace pelorus
