#pragma once
// One thread of another process, held still while its other threads go on: what a thread that hangs looks like from
// outside. By ptrace, so only for processes that the test may trace (its own children).

#include <sys/ptrace.h>
#include <sys/wait.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace pelorus::test {

// The thread of that name (/proc/PID/task/*/comm); 0: none.
inline pid_t thread_named(pid_t process, const std::string& name) {
  std::error_code ignored;
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task", ignored)) {
    if (read_text(task.path() / "comm") == name + "\n") return std::stoi(task.path().filename());
  }
  return 0;
}

class HeldThread {
 public:
  explicit HeldThread(pid_t thread) : thread_(thread) {
    if (::ptrace(PTRACE_SEIZE, thread_, nullptr, nullptr) != 0) {
      error_ = errno;
      return;
    }
    (void)::ptrace(PTRACE_INTERRUPT, thread_, nullptr, nullptr);
    int status = 0;
    held_ = ::waitpid(thread_, &status, __WALL) == thread_ && WIFSTOPPED(status);
  }
  ~HeldThread() { release(); }
  HeldThread(const HeldThread&) = delete;
  HeldThread& operator=(const HeldThread&) = delete;

  // False: no such thread, or it is refused().
  [[nodiscard]] bool held() const { return held_; }
  // This machine lets nobody trace it.
  [[nodiscard]] bool refused() const { return error_ == EPERM; }
  void release() {
    if (held_) (void)::ptrace(PTRACE_DETACH, thread_, nullptr, nullptr);
    held_ = false;
  }

 private:
  pid_t thread_;
  bool held_ = false;
  int error_ = 0;
};

}  // namespace pelorus::test
