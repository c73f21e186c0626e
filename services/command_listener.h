#pragma once
// CommandListener: VIS_COMMAND in, VIS_COMMAND_ACK out, on a thread and a connection of its own, because liblcm's first
// subscription tests the network for up to ten seconds. The handler is called on that thread and answers at once; it is
// not called after the listener's end. The end waits for the thread for a moment only: one that is caught in that test
// is left to itself, and owns all that it touches.

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "core/base/time.h"
#include "services/service_settings.h"

namespace pelorus {

struct CommandAnswer {
  bool accepted = false;
  std::string text;  // why not, or what was done
};

class CommandListener {
 public:
  using Handler = std::function<CommandAnswer(const std::string& command, const std::string& argument)>;
  // The clock of all messages; called on the listener's thread, which may outlive the listener.
  using Now = std::function<Timestamp()>;
  CommandListener(const LcmConfig& config, Handler handler, Now now);
  ~CommandListener();
  CommandListener(const CommandListener&) = delete;
  CommandListener& operator=(const CommandListener&) = delete;

 private:
  struct Shared;  // with the thread, which may outlive the listener

  std::shared_ptr<Shared> shared_;
  std::thread thread_;
};

}  // namespace pelorus
