#pragma once
// formatted: printf into a string, for the short lines of tables and pages. Pure.

#include <array>
#include <cstdarg>
#include <cstdio>
#include <string>

namespace pelorus {

// Cut at 511 characters.
[[nodiscard]] __attribute__((format(printf, 1, 2))) inline std::string formatted(const char* pattern, ...) {
  std::array<char, 512> text{};
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text.data(), text.size(), pattern, arguments);
  va_end(arguments);
  return text.data();
}

}  // namespace pelorus
