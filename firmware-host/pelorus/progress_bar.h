#pragma once
// One line on stderr that shows how far long work has come, with rate and time left. Silent when stderr is no terminal,
// so that logs stay clean. Thread-bound.

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

namespace pelorus {

class ProgressBar {
 public:
  // total 0: unknown, only the count is shown. `unit` in the plural: "pairs".
  ProgressBar(std::string title, std::size_t total, std::string unit)
      : title_(std::move(title)), unit_(std::move(unit)), total_(total), shown_on_tty_(isatty(STDERR_FILENO) == 1) {}
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { clear(); }

  void update(std::size_t done) {
    const double now_s = elapsed_s();
    if (!shown_on_tty_ || (now_s - drawn_at_s_ < 0.1 && done != total_)) return;
    drawn_at_s_ = now_s;
    const double rate = now_s > 0 ? static_cast<double>(done) / now_s : 0;
    if (total_ == 0) {
      std::fprintf(stderr, "\r\033[K%s %zu %s, %.1f/s", title_.c_str(), done, unit_.c_str(), rate);
    } else {
      constexpr std::size_t kWidth = 30;
      const std::size_t filled = std::min(kWidth, done * kWidth / total_);
      const double left_s = rate > 0 ? static_cast<double>(total_ - std::min(done, total_)) / rate : 0;
      std::fprintf(stderr, "\r\033[K%s [%s%s] %zu/%zu %s, %.1f/s, %.0f s left", title_.c_str(),
                   std::string(filled, '#').c_str(), std::string(kWidth - filled, '.').c_str(), done, total_,
                   unit_.c_str(), rate, left_s);
    }
    std::fflush(stderr);
  }

  // Removes the line, so that a message or an error starts on a clean one.
  void clear() {
    if (shown_on_tty_ && drawn_at_s_ >= 0) std::fprintf(stderr, "\r\033[K");
    drawn_at_s_ = -1;
  }

  // A line of its own above the bar.
  void tell(const std::string& line) {
    clear();
    std::fprintf(stderr, "%s\n", line.c_str());
  }

  [[nodiscard]] double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::string title_;
  std::string unit_;
  std::size_t total_;
  bool shown_on_tty_;
  double drawn_at_s_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace pelorus
