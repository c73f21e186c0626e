#include "services/side_thread.h"

#include "core/base/check.h"

namespace pelorus {
namespace {

constexpr int kSpins = 300;  // with a pause each some ten microseconds: what a wake-up costs

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

SideThread::SideThread(std::function<void()> on_thread_start)
    : thread_([this, prepare = std::move(on_thread_start)] {
        if (prepare) prepare();
        run();
      }) {}

SideThread::~SideThread() {
  wait();
  ending_.store(true, std::memory_order_relaxed);
  started_.fetch_add(1, std::memory_order_release);
  started_.notify_one();
  thread_.join();
}

void SideThread::start(SideWork work) {
  PELORUS_CHECK(done(), "a side thread does one piece of work at a time");
  work_ = work;
  started_.fetch_add(1, std::memory_order_release);
  started_.notify_one();
}

bool SideThread::done() const {
  return finished_.load(std::memory_order_acquire) == started_.load(std::memory_order_relaxed);
}

void SideThread::wait() {
  for (int spin = 0; spin < kSpins; ++spin) {
    if (done()) return;
    pause();
  }
  const std::uint32_t wanted = started_.load(std::memory_order_relaxed);
  for (std::uint32_t seen = finished_.load(std::memory_order_acquire); seen != wanted;
       seen = finished_.load(std::memory_order_acquire)) {
    finished_.wait(seen, std::memory_order_acquire);
  }
}

void SideThread::run() {
  for (std::uint32_t taken = 0;; ++taken) {
    started_.wait(taken, std::memory_order_acquire);
    if (ending_.load(std::memory_order_relaxed)) return;
    work_.run(work_.on);
    // Sequentially consistent: notify_one() looks for waiters, and must not look before this store is seen, else one
    // that counts itself in meanwhile is never woken.
    finished_.store(taken + 1, std::memory_order_seq_cst);
    finished_.notify_one();
  }
}

}  // namespace pelorus
