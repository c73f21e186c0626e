#include "firmware-host/pelorus/top/terminal.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace pelorus {
namespace {

// Everything, also over a slow line that takes it in parts.
void send(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t some = ::write(STDOUT_FILENO, bytes.data() + sent, bytes.size() - sent);
    if (some > 0) sent += static_cast<std::size_t>(some);
    if (some < 0 && errno != EINTR && errno != EAGAIN) return;
  }
}

}  // namespace

bool Terminal::is_usable() {
  const char* kind = std::getenv("TERM");
  return ::isatty(STDOUT_FILENO) == 1 && kind != nullptr && std::strcmp(kind, "dumb") != 0 && kind[0] != '\0';
}

PageSize Terminal::size() {
  winsize told{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &told) != 0 || told.ws_col == 0 || told.ws_row == 0) return {};
  return {told.ws_col, told.ws_row};
}

Terminal::Terminal() {
  if (::isatty(STDIN_FILENO) == 1 && ::tcgetattr(STDIN_FILENO, &before_) == 0) {
    termios ours = before_;
    ours.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    ours.c_cc[VMIN] = 0;
    ours.c_cc[VTIME] = 0;
    // Suspended or aborted, the page would stay on the screen; Ctrl-C remains.
    ours.c_cc[VSUSP] = _POSIX_VDISABLE;
    ours.c_cc[VQUIT] = _POSIX_VDISABLE;
    changed_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &ours) == 0;
  }
  if (::isatty(STDERR_FILENO) == 1) {
    stderr_ = UniqueFd(::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3));
    const UniqueFd nowhere(::open("/dev/null", O_WRONLY | O_CLOEXEC));
    if (stderr_ && nowhere) (void)::dup2(nowhere.get(), STDERR_FILENO);
  }
  send("\033[?1049h\033[?25l");
}

Terminal::~Terminal() {
  send("\033[0m\033[?25h\033[?1049l");
  if (stderr_) (void)::dup2(stderr_.get(), STDERR_FILENO);
  if (changed_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void Terminal::show(const std::vector<std::string>& lines) const {
  // No clearing first: what stays the same does not flicker.
  std::string bytes = "\033[H";
  for (std::size_t i = 0; i < lines.size(); ++i) bytes += (i == 0 ? "" : "\r\n") + lines[i] + "\033[K";
  send(bytes + "\033[J");
}

char Terminal::key() const {
  pollfd readable{STDIN_FILENO, POLLIN, 0};
  char c = '\0';
  if (!changed_ || ::poll(&readable, 1, 0) <= 0 || ::read(STDIN_FILENO, &c, 1) != 1) return '\0';
  return c;
}

}  // namespace pelorus
