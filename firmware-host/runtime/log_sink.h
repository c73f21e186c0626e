#pragma once
// LogSink: lines for people on stderr. Under systemd's journal each line carries its priority ("<6>..."), on a terminal
// the time. State changes only, never per frame. Thread-bound to the main thread.

#include <map>
#include <string>
#include <string_view>

#include "core/base/time.h"

namespace pelorus {

enum class LogLevel { error = 3, warning = 4, notice = 5, info = 6 };  // of syslog

class LogSink {
 public:
  // `to_journal`: whether stderr is the journal (see stderr_is_journal).
  explicit LogSink(bool to_journal);

  void line(LogLevel level, const std::string& text);
  // At most one line a second for each cause; what was held back is said with the next one of that cause.
  void limited(LogLevel level, std::string_view cause, const std::string& text, Timestamp now);

 private:
  struct Cause {
    Timestamp last;
    int held_back = 0;
  };
  bool to_journal_;
  std::map<std::string, Cause, std::less<>> causes_;
};

// By JOURNAL_STREAM (systemd.exec(5)): device and inode of the stream that the service manager connected.
[[nodiscard]] bool stderr_is_journal();

}  // namespace pelorus
