#include "core/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace pelorus {

void check_failed(const char* expression, const char* file, int line, const char* message) {
  std::fprintf(stderr, "%s:%d: broken invariant: %s (%s)\n", file, line, message, expression);
  std::abort();
}

}  // namespace pelorus
