#pragma once
// Work handed to another thread. Core starts no thread: services own them (services/side_thread.h) and lend them here.
// One piece at a time, started and waited for by the same thread. start() and wait() touch neither heap nor lock.

namespace pelorus {

struct SideWork {
  void (*run)(void* on) = nullptr;
  void* on = nullptr;
};

// A piece of work that calls the member function `Do` of `on`.
template <auto Do, class T>
[[nodiscard]] SideWork work_of(T& on) {
  return {[](void* self) { (static_cast<T*>(self)->*Do)(); }, &on};
}

class SideWorker {
 public:
  virtual ~SideWorker() = default;
  // Returns at once; the piece before must be done.
  virtual void start(SideWork work) = 0;
  [[nodiscard]] virtual bool done() const = 0;
  virtual void wait() = 0;
};

// No other thread: the piece is done where it is started. Results are the same.
class InlineWorker final : public SideWorker {
 public:
  void start(SideWork work) override { work.run(work.on); }
  [[nodiscard]] bool done() const override { return true; }
  void wait() override {}
};

}  // namespace pelorus
