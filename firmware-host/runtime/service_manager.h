#pragma once
// ServiceManager: what systemd wants to hear of a Type=notify service (sd_notify(3)): a datagram to the socket named in
// NOTIFY_SOCKET. Without that variable, started by hand, every call does nothing. Thread-bound.

#include <chrono>
#include <optional>
#include <string>

namespace pelorus {

class ServiceManager {
 public:
  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceManager();

  // "READY=1", "STATUS=...", "STOPPING=1", "WATCHDOG=1"; several lines at once. False: nobody listens.
  bool notify(const std::string& state) const;
  // Within this time WATCHDOG=1 has to come, or the service is killed; empty when nobody watches.
  [[nodiscard]] std::optional<std::chrono::microseconds> watchdog() const { return watchdog_; }

 private:
  std::string socket_;
  std::optional<std::chrono::microseconds> watchdog_;
};

}  // namespace pelorus
