#pragma once
// App: the service, put together from its configuration; the only place where the concrete parts meet. Threads are
// built from the buses to the cameras and ended in the opposite order. run() is the main thread's work: signals, health
// once a second and at changes, the watchdog, the log. Thread-bound to main, whose signals must be blocked before
// (block_signals).

#include <memory>

#include "core/base/result.h"
#include "core/base/time.h"
#include "firmware-host/runtime/log_sink.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

// SIGTERM, SIGINT, SIGHUP for this thread and all it will start: run() takes them one by one.
void block_signals();

struct HealthReport;

class App {
 public:
  // Errors: the source or its calibration cannot be used.
  [[nodiscard]] static Result<std::unique_ptr<App>> create(const ServiceConfig& config, LogSink& log);
  ~App();

  // Until SIGTERM or SIGINT, or the end of recorded pairs. Returns the exit code.
  [[nodiscard]] int run();

 private:
  struct Parts;
  explicit App(LogSink& log);
  void tick();
  void take_samples();
  void report_health();
  void report_changes();
  void send_report(HealthReport& report, Timestamp now);
  void look_at_progress();
  void feed_watchdog();
  void log_cameras();
  void log_exchanged_sides();
  void log_state();
  [[nodiscard]] bool wait_for_signal();

  std::unique_ptr<Parts> parts_;
};

}  // namespace pelorus
