#include "services/command_listener.h"

#include <chrono>
#include <condition_variable>
#include <lcm/lcm-cpp.hpp>
#include <mutex>
#include <pelorus/vis_command_ack_t.hpp>
#include <pelorus/vis_command_t.hpp>

#include "services/lcm_messages.h"

#include "services/lcm_link.h"

namespace pelorus {
namespace {

constexpr int kWait_ms = 100;
constexpr auto kRetry = std::chrono::seconds(1);
constexpr auto kLongestEnd = std::chrono::milliseconds(300);

}  // namespace

struct CommandListener::Shared {
  LcmConfig config;
  Now now;
  std::mutex mutex;  // of the rest; per command and at the end only
  std::condition_variable change;
  Handler handler;  // empty once the listener has ended
  bool stopping = false;
  bool ended = false;

  [[nodiscard]] bool asked_to_stop() {
    const std::lock_guard lock(mutex);
    return stopping;
  }
  CommandAnswer answer(const std::string& command, const std::string& argument) {
    const std::lock_guard lock(mutex);
    return handler ? handler(command, argument) : CommandAnswer{false, "ending"};
  }
  void run();
};

namespace {

// One connection with its subscription.
class Session {
 public:
  Session(const LcmConfig& config, CommandListener::Handler handler, CommandListener::Now now)
      : lcm_(config.url),
        handler_(std::move(handler)),
        now_(std::move(now)),
        ack_channel_(config.vehicle + ".VIS_COMMAND_ACK") {
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
    ack.utime = utime_of(now_());
    ack.id = command->id;
    ack.command = command->command;
    ack.accepted = answer.accepted;
    ack.text = answer.text;
    lcm_.publish(ack_channel_, &ack);
  }

  lcm::LCM lcm_;
  CommandListener::Handler handler_;
  CommandListener::Now now_;
  std::string ack_channel_;
  lcm::Subscription* subscription_ = nullptr;
};

}  // namespace

CommandListener::CommandListener(const LcmConfig& config, Handler handler, Now now)
    : shared_(std::make_shared<Shared>()) {
  shared_->config = config;
  shared_->now = std::move(now);
  shared_->handler = std::move(handler);
  thread_ = std::thread([shared = shared_] { shared->run(); });
}

CommandListener::~CommandListener() {
  std::unique_lock lock(shared_->mutex);
  shared_->stopping = true;
  shared_->handler = nullptr;
  shared_->change.notify_all();
  const bool ended = shared_->change.wait_for(lock, kLongestEnd, [this] { return shared_->ended; });
  lock.unlock();
  ended ? thread_.join() : thread_.detach();
}

void CommandListener::Shared::run() {
  while (!asked_to_stop()) {
    if (lcm_can_open(config.url)) {
      Session session(
          config, [this](const std::string& command, const std::string& argument) { return answer(command, argument); },
          now);
      while (session.good() && !asked_to_stop() && session.wait()) {
      }
    }
    std::unique_lock lock(mutex);
    change.wait_for(lock, kRetry, [this] { return stopping; });
  }
  const std::lock_guard lock(mutex);
  ended = true;
  change.notify_all();
}

}  // namespace pelorus
