#pragma once
// CommandListener: VIS_COMMAND in, VIS_COMMAND_ACK out, on a thread and a connection of its own, because liblcm's first
// subscription tests the network for up to ten seconds. The handler is called on that thread and answers at once.
// A stop takes at most 0.1 s, or that self-test.

#include <functional>
#include <stop_token>
#include <string>
#include <thread>

#include "services/service_settings.h"

namespace pelorus {

struct CommandAnswer {
  bool accepted = false;
  std::string text;  // why not, or what was done
};

class CommandListener {
 public:
  using Handler = std::function<CommandAnswer(const std::string& command, const std::string& argument)>;
  CommandListener(const LcmConfig& config, Handler handler);

 private:
  void run(const std::stop_token& stop);

  LcmConfig config_;
  Handler handler_;
  std::jthread thread_;  // last: everything above is ready when it starts
};

}  // namespace pelorus
