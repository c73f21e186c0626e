#pragma once
// What the program asks of the operating system: memory that stays, real-time scheduling of the threads that need it.
// Each is a wish: refused, the service goes on without and says so. Any thread, at its start.

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace pelorus {

// Empty when granted, else why not. Asks only when the limit allows all of it: a partly locked process would be refused
// memory later (mlockall(2), MCL_FUTURE).
[[nodiscard]] std::string lock_memory();

enum class ThreadClass {
  fifo_high,     // capture: a picture waits for nobody
  fifo_release,  // publishing: little work, at an exact moment, also while vision computes
  fifo_middle,   // vision, and what shares its work
  fifo_low,      // detection, beside vision
  fifo_behind,   // the window behind the step: when nobody else works, yet before all that is not real time
  normal,
  background  // previews, recording
};

inline constexpr int kAnyProcessor = -1;
// The processors in the order in which threads that compute side by side are bound to them: the last first, and those
// that share a core with one taken already only when no core is left. core_of(processor) names its core.
[[nodiscard]] std::vector<int> binding_order(std::span<const int> processors, const std::function<int(int)>& core_of);
// The n-th of them among those this process may use; wraps around.
[[nodiscard]] int processor_to_bind(int n);

// Names the calling thread (15 characters), sets its class and binds it to a processor. Empty when granted, else why
// not.
[[nodiscard]] std::string set_thread(const char* name, ThreadClass wanted, int processor = kAnyProcessor);

// Whether threads may be kept to one processor; empty, or why not.
[[nodiscard]] std::string pin_refusal();
// Whether the process may use real-time scheduling at all; empty, or why not.
[[nodiscard]] std::string realtime_refusal();

}  // namespace pelorus
