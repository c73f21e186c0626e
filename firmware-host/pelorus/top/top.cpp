#include "firmware-host/pelorus/top/top.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "firmware-host/pelorus/bus_options.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"
#include "firmware-host/pelorus/top/bus_listener.h"
#include "firmware-host/pelorus/top/status_page.h"
#include "firmware-host/pelorus/top/terminal.h"

namespace pelorus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kNotHeardExitCode = 1;
constexpr auto kPatience = std::chrono::milliseconds(50);
constexpr auto kRedraw = std::chrono::milliseconds(200);
constexpr auto kPlainPeriod = std::chrono::seconds(1);

struct TopArguments {
  BusOptions bus;
  bool once = false;
  bool json = false;
  double timeout_s = 5;
};

std::vector<std::string> page_lines(const BusView& view, PageSize size, bool colored) {
  std::vector<std::string> lines;
  for (const PageLine& line : status_page(view, Clock::now(), size)) {
    lines.push_back(colored ? colored_text(line) : plain_text(line));
  }
  return lines;
}

void print(const BusView& view, bool json) {
  if (json) {
    std::printf("%s\n", status_json(view, Clock::now()).c_str());
  } else {
    for (const std::string& line : page_lines(view, {}, false)) std::printf("%s\n", line.c_str());
  }
  std::fflush(stdout);
}

std::string not_heard(const BusView& view, double timeout_s) {
  std::string channels;
  const auto note = [&](bool heard, const char* channel) {
    if (!heard) channels += (channels.empty() ? "" : ", ") + view.vehicle + "." + channel;
  };
  note(view.odom.has_value(), "VIS_ODOM");
  note(view.tracks.has_value(), "VIS_TRACKS");
  note(view.health.has_value(), "VIS_HEALTH");
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%g s", timeout_s);
  return view.url + ": nothing heard within " + seconds.data() + " on " + channels +
         " (is pelorusd running with this lcm.url and lcm.vehicle, and is there a way to it? pelorus doctor)";
}

Result<int> show_once(BusListener& listener, const TopArguments& arguments) {
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(static_cast<long>(1e3 * arguments.timeout_s));
  while (!listener.view().complete() && Clock::now() < end) {
    listener.listen(kPatience);
    if (ReplayInterrupt::requested()) return kInterruptedExitCode;
  }
  const BusView& view = listener.view();
  if (!view.trouble.empty()) return Error{ErrorCode::io, view.url, view.trouble, ""};
  if (!view.complete()) {
    std::fprintf(stderr, "pelorus: %s\n", not_heard(view, arguments.timeout_s).c_str());
    return kNotHeardExitCode;
  }
  print(view, arguments.json);
  return 0;
}

// For a pipe or a file: whole pages, one a second.
int print_on(BusListener& listener, bool json) {
  Clock::time_point next = Clock::now() + kPlainPeriod;
  while (!ReplayInterrupt::requested() && std::ferror(stdout) == 0) {
    listener.listen(kPatience);
    if (Clock::now() < next) continue;
    next += kPlainPeriod;
    print(listener.view(), json);
  }
  return 0;
}

int show_on(BusListener& listener) {
  const bool colored = std::getenv("NO_COLOR") == nullptr;  // no-color.org
  const Terminal terminal;
  PageSize shown{0, 0};
  Clock::time_point next{};
  while (!ReplayInterrupt::requested()) {
    const char key = terminal.key();
    if (key == 'q' || key == 'Q') break;
    const PageSize size = Terminal::size();
    if (Clock::now() >= next || size.columns != shown.columns || size.rows != shown.rows) {
      terminal.show(page_lines(listener.view(), size, colored));
      shown = size;
      next = Clock::now() + kRedraw;
    }
    listener.listen(kPatience);
  }
  return 0;
}

Result<int> run_top(const TopArguments& arguments) {
  const Result<LcmConfig> bus = arguments.bus.resolve();
  if (!bus) return bus.error();
  const ReplayInterrupt interrupt;
  BusListener listener(bus.value().url, bus.value().vehicle);
  if (arguments.once) return show_once(listener, arguments);
  if (arguments.json || !Terminal::is_usable()) return print_on(listener, arguments.json);
  return show_on(listener);
}

}  // namespace

Verb add_top(CLI::App& app) {
  auto arguments = std::make_shared<TopArguments>();
  CLI::App* parser = app.add_subcommand("top", "What the service is doing, heard over LCM; also over SSH");
  arguments->bus.add_to(*parser);
  parser->add_flag("--once", arguments->once, "Show once, when every channel was heard, and end");
  parser->add_flag("--json", arguments->json, "JSON objects, one a line, in place of pages");
  parser->add_option("--timeout", arguments->timeout_s, "How long --once waits [s]")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  parser->footer(
      "q or Ctrl-C ends. Without a terminal: a page a second, plain. NO_COLOR in the environment: no colors.\n"
      "Exit codes: 0 ended, 1 --once: not every channel heard in time, 2 usage, 5 configuration, 6 a file cannot be\n"
      "read or LCM cannot be opened, 130 --once interrupted.");
  return {parser, [arguments] { return run_top(*arguments); }};
}

}  // namespace pelorus
