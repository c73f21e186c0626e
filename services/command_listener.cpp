#include "services/command_listener.h"

#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <pelorus/vis_command_ack_t.hpp>
#include <pelorus/vis_command_t.hpp>

namespace pelorus {
namespace {

constexpr int kWait_ms = 100;
constexpr int kRetryTurns = 10;

std::int64_t now_us() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

// One connection with its subscription.
class Session {
 public:
  Session(const LcmConfig& config, const CommandListener::Handler& handler)
      : lcm_(config.url), handler_(handler), ack_channel_(config.vehicle + ".VIS_COMMAND_ACK") {
    if (!lcm_.good()) return;
    subscription_ = lcm_.subscribe(config.vehicle + ".VIS_COMMAND", &Session::take, this);
  }

  // Where multicast leaves but does not come back (a firewall), LCM has no socket to wait on, and waiting would abort.
  [[nodiscard]] bool good() { return subscription_ != nullptr && lcm_.getFileno() >= 0; }
  // False: the connection is of no more use.
  [[nodiscard]] bool wait() { return lcm_.handleTimeout(kWait_ms) >= 0; }

 private:
  void take(const lcm::ReceiveBuffer*, const std::string&, const vis_command_t* command) {
    const CommandAnswer answer = handler_(command->command, command->argument);
    vis_command_ack_t ack{};
    ack.utime = now_us();
    ack.id = command->id;
    ack.command = command->command;
    ack.accepted = answer.accepted;
    ack.text = answer.text;
    lcm_.publish(ack_channel_, &ack);
  }

  lcm::LCM lcm_;
  const CommandListener::Handler& handler_;
  std::string ack_channel_;
  lcm::Subscription* subscription_ = nullptr;
};

}  // namespace

CommandListener::CommandListener(const LcmConfig& config, Handler handler)
    : config_(config), handler_(std::move(handler)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void CommandListener::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    Session session(config_, handler_);
    while (session.good() && !stop.stop_requested() && session.wait()) {
    }
    for (int turn = 0; turn < kRetryTurns && !stop.stop_requested(); ++turn) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kWait_ms));
    }
  }
}

}  // namespace pelorus
