#pragma once
// ReplayInterrupt: while alive, the first Ctrl-C (SIGINT) or SIGTERM is a request that requested() reports, so that a
// run ends with valid files; the second one kills, as ever. One at a time per process; the handler is async-signal
// safe. Main thread.

#include <csignal>

namespace pelorus {

inline constexpr int kInterruptedExitCode = 130;  // the shell's convention for SIGINT: 128 + 2

class ReplayInterrupt {
 public:
  ReplayInterrupt();
  ~ReplayInterrupt();
  ReplayInterrupt(const ReplayInterrupt&) = delete;
  ReplayInterrupt& operator=(const ReplayInterrupt&) = delete;
  [[nodiscard]] static bool requested();

 private:
  struct sigaction previous_int_ {};
  struct sigaction previous_term_ {};
};

}  // namespace pelorus
