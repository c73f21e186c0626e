#include "firmware-host/pelorus/command/service_command.h"

#include <array>
#include <chrono>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <optional>
#include <pelorus/vis_command_ack_t.hpp>
#include <pelorus/vis_command_t.hpp>
#include <random>
#include <string>

#include "firmware-host/pelorus/bus_options.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"

namespace pelorus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kNotDoneExitCode = 1;
constexpr int kPatience_ms = 50;

struct CommandArguments {
  std::string command;
  BusOptions bus;
  double timeout_s = 5;
};

std::int64_t now_us() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

// One command and its answer. Sent once: a service does what it is told as often as it is told.
class Exchange {
 public:
  Exchange(const LcmConfig& config, const std::string& command)
      : lcm_(config.url), command_channel_(config.vehicle + ".VIS_COMMAND") {
    command_.id = static_cast<std::int32_t>(std::random_device{}() >> 1U);  // others may be sending too
    command_.command = command;
    // LCM takes channels as regular expressions, and a vehicle's name may hold anything: the id tells the answer.
    if (lcm_.good()) lcm_.subscribe(".*[.]VIS_COMMAND_ACK", &Exchange::take, this);
  }

  // Where multicast leaves but does not come back (a firewall), LCM has no socket to wait on, and waiting would abort.
  [[nodiscard]] bool good() { return lcm_.good() && lcm_.getFileno() >= 0; }
  [[nodiscard]] bool send() {
    command_.utime = now_us();
    return lcm_.publish(command_channel_, &command_) == 0;
  }
  void listen() { (void)lcm_.handleTimeout(kPatience_ms); }
  [[nodiscard]] const std::optional<vis_command_ack_t>& answer() const { return answer_; }
  [[nodiscard]] const std::string& channel() const { return command_channel_; }

 private:
  void take(const lcm::ReceiveBuffer*, const std::string&, const vis_command_ack_t* ack) {
    if (ack->id == command_.id && ack->command == command_.command) answer_ = *ack;
  }

  lcm::LCM lcm_;
  std::string command_channel_;
  vis_command_t command_{};
  std::optional<vis_command_ack_t> answer_;
};

Error cannot_reach(const LcmConfig& config, const std::string& what) {
  return {ErrorCode::io, config.url, what, "is there a multicast route, and no firewall? pelorus doctor tells"};
}

std::string not_answered(const Exchange& exchange, const CommandArguments& arguments, const LcmConfig& config) {
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%g s", arguments.timeout_s);
  return config.url + ": no answer within " + seconds.data() + " to '" + arguments.command + "' on " +
         exchange.channel() +
         " (is pelorusd running there with this lcm.url, lcm.vehicle and lcm.commands: true? ttl=0 in the url does not "
         "leave a computer; pelorus top shows what is heard)";
}

Result<int> run_command(const CommandArguments& arguments) {
  const Result<LcmConfig> bus = arguments.bus.resolve();
  if (!bus) return bus.error();
  const ReplayInterrupt interrupt;
  Exchange exchange(bus.value(), arguments.command);
  if (!exchange.good()) return cannot_reach(bus.value(), "LCM cannot be opened");
  if (!exchange.send()) return cannot_reach(bus.value(), "the command cannot be sent");
  const auto end = Clock::now() + std::chrono::milliseconds(static_cast<long>(1e3 * arguments.timeout_s));
  while (!exchange.answer() && Clock::now() < end) {
    if (ReplayInterrupt::requested()) return kInterruptedExitCode;
    exchange.listen();
  }
  if (!exchange.answer()) {
    std::fprintf(stderr, "pelorus: %s\n", not_answered(exchange, arguments, bus.value()).c_str());
    return kNotDoneExitCode;
  }
  const vis_command_ack_t& answer = *exchange.answer();
  if (answer.accepted) {
    std::printf("%s: %s\n", arguments.command.c_str(), answer.text.c_str());
    return 0;
  }
  std::fprintf(stderr, "pelorus: the service refuses '%s': %s\n", arguments.command.c_str(), answer.text.c_str());
  return kNotDoneExitCode;
}

}  // namespace

Verb add_command(CLI::App& app) {
  auto arguments = std::make_shared<CommandArguments>();
  CLI::App* parser = app.add_subcommand("command", "Tell the running service something, over LCM; also over SSH");
  parser
      ->add_option("COMMAND", arguments->command,
                   "reset: the world starts anew; standby, resume: rest and work; snapshot: a picture on "
                   "VIS_IMAGE_LEFT; record_start, record_stop: the recorder")
      ->required()
      ->check(one_of({"reset", "standby", "resume", "snapshot", "record_start", "record_stop"}));
  arguments->bus.add_to(*parser);
  parser->add_option("--timeout", arguments->timeout_s, "How long to wait for the answer [s]")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  parser->footer(
      "Prints the service's answer. What the command led to shows in the state: pelorus top.\n"
      "Exit codes: 0 accepted, 1 refused or no answer in time, 2 usage, 5 configuration, 6 a file cannot be read or "
      "LCM\n"
      "cannot be opened, 130 interrupted.");
  return {parser, [arguments] { return run_command(*arguments); }};
}

}  // namespace pelorus
