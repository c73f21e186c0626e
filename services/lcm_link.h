#pragma once
// LcmLink: a connection to LCM that survives a network that is not there yet or goes away: opened when needed, and
// again after failures, at most once a second. Thread-bound; the state may be read by any thread. Nothing of LCM's
// exceptions or prints is relied on; a failure is a counter. (liblcm 1.3.1 cannot be opened without a multicast route,
// which it tells in ten lines on the terminal each time: the route is looked for before; and publishing may fail at any
// time.)

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "core/base/counter.h"

namespace lcm {
class LCM;
}

namespace pelorus {

// Whether it can be opened as far as the kernel's routes say: a URL that is no multicast address is for LCM to judge.
[[nodiscard]] bool lcm_can_open(const std::string& url);

class LcmLink {
 public:
  explicit LcmLink(std::string url);
  ~LcmLink();

  // The open connection, or nullptr for now.
  [[nodiscard]] lcm::LCM* connection();
  // Tells how the last use went, no connection to be had being a failure; after a second of nothing but failures
  // although there is a route the connection is made anew.
  void note(bool success);

  // Uses that failed.
  [[nodiscard]] std::uint64_t errors() const { return errors_.value(); }
  // Attempts to open it, at most one a second.
  [[nodiscard]] std::uint64_t attempts() const { return attempts_.value(); }
  [[nodiscard]] std::uint64_t reconnects() const { return reconnects_.value(); }
  // The last use went well: false from the first message that does not leave.
  [[nodiscard]] bool works() const { return works_.value() != 0; }

 private:
  using Clock = std::chrono::steady_clock;

  std::string url_;
  std::unique_ptr<lcm::LCM> lcm_;
  Clock::time_point next_try_{};
  Clock::time_point failing_since_{};
  bool failing_ = false;
  bool was_open_ = false;
  Counter errors_;
  Counter attempts_;
  Counter reconnects_;
  Counter works_;
};

}  // namespace pelorus
