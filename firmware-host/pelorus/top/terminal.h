#pragma once
// Terminal: while alive, the terminal shows our page on its alternate screen, keys come one by one without echo, and
// what libraries print to stderr goes nowhere; the destructor puts everything back. One at a time. Main thread.

#include <termios.h>

#include <string>
#include <vector>

#include "drivers/unique_fd.h"
#include "firmware-host/pelorus/top/status_page.h"

namespace pelorus {

class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // stdout is a terminal that moves its cursor.
  [[nodiscard]] static bool is_usable();
  [[nodiscard]] static PageSize size();
  void show(const std::vector<std::string>& lines) const;
  // The next key pressed, or '\0'.
  [[nodiscard]] char key() const;

 private:
  termios before_{};
  bool changed_ = false;
  UniqueFd stderr_;
};

}  // namespace pelorus
