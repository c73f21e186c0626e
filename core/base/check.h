#pragma once
// PELORUS_CHECK: for bugs (broken invariants), never for bad input or ordinary outcomes (CONVENTIONS, errors).
// Prints expression, place and message, then aborts; the service manager restarts the service. Thread-safe.

namespace pelorus {
[[noreturn]] void check_failed(const char* expression, const char* file, int line, const char* message);
}

#define PELORUS_CHECK(expression, message) \
  (static_cast<bool>(expression) ? void(0) : ::pelorus::check_failed(#expression, __FILE__, __LINE__, message))
