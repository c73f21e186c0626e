#pragma once
// SideThread: a thread that does the pieces of work the step hands to it. Handing over and waiting cost a store and a
// wake-up; no lock, no heap. The waiter spins briefly, since the pieces are short, then sleeps.

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

#include "core/pipeline/pipeline.h"

namespace pelorus {

class SideThread final : public SideWorker {
 public:
  explicit SideThread(std::function<void()> on_thread_start = {});
  ~SideThread() override;
  SideThread(const SideThread&) = delete;
  SideThread& operator=(const SideThread&) = delete;

  void start(SideWork work) override;
  [[nodiscard]] bool done() const override;
  void wait() override;
  // Pieces done so far: for the watchdog. Thread-safe, as done() is.
  [[nodiscard]] std::uint32_t finished() const { return finished_.load(std::memory_order_relaxed); }

 private:
  void run();

  SideWork work_;  // written before `started_` grows, read after
  std::atomic<std::uint32_t> started_{0};
  std::atomic<std::uint32_t> finished_{0};
  std::atomic<bool> ending_{false};
  std::thread thread_;  // last: everything above is ready when it starts
};

// The threads that one pipeline works with, by what they do (ARCHITECTURE, threads and latency).
struct PipelineThreads {
  SideThread tracking;  // shares KLT with the thread that steps
  SideThread surf;      // looks for new points while the step goes on
  SideThread refine;    // the window of the ego motion, behind the step

  [[nodiscard]] PipelineWorkers workers(bool wait_for_refine) { return {&tracking, &surf, &refine, wait_for_refine}; }
};

}  // namespace pelorus
