#pragma once
// Wake: one thread tells another that there is something to look at (eventfd). ring() never waits; rings add up to one.
// Thread-safe for any number of ringers and one waiter.

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

#include "core/base/check.h"
#include "core/base/time.h"
#include "drivers/unique_fd.h"

namespace pelorus {

class Wake {
 public:
  Wake() : fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    PELORUS_CHECK(static_cast<bool>(fd_), "no event descriptor to wake a thread with");
  }

  void ring() {
    const std::uint64_t one = 1;
    // Fails only when the counter is at its limit, and then the waiter is awake already.
    [[maybe_unused]] const ssize_t written = ::write(fd_.get(), &one, sizeof one);
  }
  // Returns when rung, also before the call, or when the time is over.
  void wait(Duration timeout) {
    const std::int64_t ns = std::max<std::int64_t>(timeout.count(), 0);
    const timespec limit{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
    pollfd wake{fd_.get(), POLLIN, 0};
    if (::ppoll(&wake, 1, &limit, nullptr) <= 0) return;
    std::uint64_t rung = 0;
    [[maybe_unused]] const ssize_t got = ::read(fd_.get(), &rung, sizeof rung);
  }

 private:
  UniqueFd fd_;
};

}  // namespace pelorus
