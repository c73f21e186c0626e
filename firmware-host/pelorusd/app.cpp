#include "firmware-host/pelorusd/app.h"

#include <signal.h>

#include <array>
#include <cstdio>
#include <optional>
#include <thread>

#include "firmware-host/pelorusd/health_gather.h"
#include "firmware-host/pelorusd/progress_watch.h"
#include "firmware-host/pelorusd/service_threads.h"
#include "firmware-host/pelorusd/wall_step_watch.h"
#include "firmware-host/runtime/service_manager.h"
#include "services/health.h"
#include "services/host_facts.h"

namespace pelorus {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kTick = std::chrono::milliseconds(50);
constexpr auto kHealthPeriod = std::chrono::seconds(1);
constexpr auto kLeastBetweenChanges = std::chrono::milliseconds(100);
constexpr auto kLongestStandstill = std::chrono::milliseconds(2000);
// Of the refinement, the last to be given a processor: where there are too few it is late, and results go on without
// it. So long without one is no overload any more, but a hang.
constexpr auto kLongestRefinement = std::chrono::seconds(30);

sigset_t handled_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
  return signals;
}

std::string state_text(const ReleaseSample& sample) {
  std::string text = to_text(sample.state);
  if (sample.reason != StateReason::none) text += std::string(": ") + to_text(sample.reason);
  return text;
}

LogLevel level_of(VisionState state) {
  const bool good = state == VisionState::tracking || state == VisionState::init || state == VisionState::standby;
  return good ? LogLevel::notice : LogLevel::warning;
}

}  // namespace

void block_signals() {
  const sigset_t signals = handled_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
}

struct App::Parts {
  explicit Parts(LogSink& l) : log(l) {}

  LogSink& log;
  std::unique_ptr<ServiceThreads> service;
  ServiceManager manager;
  Health health;
  HostFacts host{""};
  ProgressWatch progress{kLongestStandstill};
  WallStepWatch wall_step;
  Timestamp started;
  std::uint64_t reports = 0;
  Clock::time_point next_health;
  std::string outputs;  // state of bus, recorder and LCM as reported last
  Clock::time_point next_change;
  HostReport host_report;
  Clock::time_point next_feed;
  bool ready = false;
  std::string state;
  std::string logged_state;
  int state_changes = 0;  // since the last line
  Clock::time_point next_state_line;
  std::vector<std::string> logged_problems;
  bool logged_stuck = false;
};

App::App(LogSink& log) : parts_(std::make_unique<Parts>(log)) {}
App::~App() = default;

Result<std::unique_ptr<App>> App::create(const ServiceConfig& config, LogSink& log) {
  auto service = ServiceThreads::start(config, log);
  if (!service) return service.error();
  std::unique_ptr<App> app(new App(log));
  app->parts_->service = std::move(service.value());
  app->parts_->host = HostFacts(config.recorder.folder);
  app->parts_->started = app->parts_->service->clock.now();
  return app;
}

int App::run() {
  Parts& p = *parts_;
  p.next_health = Clock::now() + kHealthPeriod;
  p.next_feed = Clock::now();
  while (!wait_for_signal()) {
    tick();
    if (!p.service->head->exhausted()) continue;
    p.log.line(LogLevel::notice, "the recording is at its end");
    report_health();
    p.service->vision.reset();
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(p.service->config.timing.latency_ms + 50));
    tick();
    break;
  }
  if (p.service->vision) report_health();  // the last word on what was counted
  p.manager.notify("STOPPING=1\nSTATUS=stopping");
  p.service->stop();
  take_samples();
  std::array<char, 96> line{};
  std::snprintf(line.data(), line.size(), "stopped after %llu results",
                static_cast<unsigned long long>(p.health.results()));
  p.log.line(LogLevel::notice, line.data());
  return 0;
}

// True: told to stop.
bool App::wait_for_signal() {
  const sigset_t signals = handled_signals();
  const timespec tick_time{0, std::chrono::nanoseconds(kTick).count()};
  const int signal = ::sigtimedwait(&signals, nullptr, &tick_time);
  if (signal == SIGHUP) {
    parts_->log.line(LogLevel::notice, "nothing is reloaded while running: restart to apply changed settings");
  }
  return signal == SIGTERM || signal == SIGINT;
}

void App::tick() {
  Parts& p = *parts_;
  take_samples();
  log_cameras();
  log_exchanged_sides();
  for (const std::string& command : parts_->service->take_obeyed()) parts_->log.line(LogLevel::notice, command);
  const Clock::time_point now = Clock::now();
  if (now >= p.next_health) {
    p.next_health = std::max(p.next_health + kHealthPeriod, now);
    report_health();
  } else if (now >= p.next_change && outputs_state(*p.service) != p.outputs) {
    p.next_change = now + kLeastBetweenChanges;
    report_changes();
  }
  feed_watchdog();
}

void App::take_samples() {
  Parts& p = *parts_;
  while (const std::optional<ReleaseSample> sample = p.service->desk.samples.try_pop()) {
    p.health.add(*sample);
    const std::string state = state_text(*sample);
    p.state_changes += state == p.state ? 0 : 1;
    p.state = state;
  }
  log_state();
  if (p.ready || p.health.results() == 0) return;
  p.ready = true;
  p.manager.notify("READY=1\nSTATUS=" + p.state);
  p.log.line(LogLevel::notice, "ready");
}

// Flicker within a second is one line, which says so; a state that lasts is always told.
void App::log_state() {
  Parts& p = *parts_;
  const Clock::time_point now = Clock::now();
  if (p.state == p.logged_state || now < p.next_state_line) return;
  const std::string flicker = p.state_changes > 1 ? " (" + std::to_string(p.state_changes) + " changes)" : "";
  p.log.line(level_of(p.health.state()), p.state + flicker);
  p.logged_state = p.state;
  p.state_changes = 0;
  p.next_state_line = now + std::chrono::seconds(1);
}

void App::log_cameras() {
  Parts& p = *parts_;
  const std::vector<CaptureStatus> cameras = p.service->head->status();
  p.logged_problems.resize(cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string problem = cameras[i].state == CaptureState::lost ? cameras[i].last_problem : "";
    if (problem == p.logged_problems[i]) continue;
    if (!problem.empty()) p.log.limited(LogLevel::warning, "camera", problem, p.service->clock.now());
    if (problem.empty()) p.log.limited(LogLevel::notice, "camera back", cameras[i].description, p.service->clock.now());
    p.logged_problems[i] = problem;
  }
}

void App::log_exchanged_sides() {
  Parts& p = *parts_;
  if (!p.service->exchanged_sides->look(p.health.state(), p.health.reason(), Clock::now())) return;
  p.log.line(
      LogLevel::error,
      "the left and right pictures are exchanged: points match only when they change places (exchange camera.left and "
      "camera.right, or the cables)");
}

void App::report_health() {
  Parts& p = *parts_;
  HealthReport& report = p.service->desk.health.draft();
  report = HealthReport{};
  const Timestamp now = p.service->clock.now();
  p.health.report(now, report);
  p.host_report = p.host.read();
  send_report(report, now);
}

// A bus, a disk or a network that fails is not kept for the rest of a second.
void App::report_changes() {
  Parts& p = *parts_;
  HealthReport& report = p.service->desk.health.draft();
  report = HealthReport{};
  const Timestamp now = p.service->clock.now();
  p.health.report_again(now, report);
  send_report(report, now);
}

void App::send_report(HealthReport& report, Timestamp now) {
  Parts& p = *parts_;
  report.seq = ++p.reports;
  report.uptime_s = seconds(now - p.started);
  report.host = p.host_report;
  const Duration wall_step = p.service->clock.wall_step();
  report.wall_step_s = seconds(wall_step);
  if (const auto warning = p.wall_step.look(wall_step)) p.log.line(LogLevel::warning, *warning);
  p.outputs = outputs_state(*p.service);
  gather_service(*p.service, report);
  report.version = PELORUS_VERSION;
  const std::vector<OutputTrouble> troubles = output_troubles(*p.service, report);
  std::string troubles_text;
  for (const OutputTrouble& trouble : troubles) {
    p.log.limited(LogLevel::warning, trouble.output, trouble.text, now);
    troubles_text += "; " + trouble.text;
  }
  std::array<char, 160> status{};
  std::snprintf(status.data(), status.size(), "STATUS=%s%s%s, %.1f Hz, latency %.1f ms", to_text(report.state),
                report.reason == StateReason::none ? "" : ": ", to_text(report.reason), report.timing.results_rate_hz,
                report.timing.latency_p50_ms);
  p.manager.notify(status.data() + troubles_text);
  p.service->desk.health.post();
  p.service->desk.wake.ring();
}

// Which parts have moved since the last look.
void App::look_at_progress() {
  Parts& p = *parts_;
  const Clock::time_point now = Clock::now();
  if (p.service->vision) p.progress.look("vision", p.service->vision->status().turns, false, now);
  p.progress.look("publishing", p.service->publishing->turns(), false, now);
  const std::vector<CaptureStatus> cameras = p.service->head->status();
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const CameraStatistics& c = cameras[i].camera;
    const bool searching = cameras[i].state != CaptureState::streaming && cameras[i].state != CaptureState::silent;
    p.progress.look("camera " + std::to_string(i), c.frames + c.timeouts + c.incomplete, searching, now);
  }
  // Vision does not wait for the refinement of the ego motion: without this its hang would show in no message.
  const SideThread& refine = p.service->workers->refine;
  p.progress.look("refinement", refine.finished(), refine.done(), now, kLongestRefinement);
}

// Fed only while every part moves: a service that hangs is better killed and started anew.
void App::feed_watchdog() {
  Parts& p = *parts_;
  look_at_progress();
  const Clock::time_point now = Clock::now();
  const std::string stuck = p.service->vision ? p.progress.stuck(now) : "";
  if (!stuck.empty() && !p.logged_stuck) p.log.line(LogLevel::error, stuck + " stands still");
  p.logged_stuck = !stuck.empty();
  if (!p.manager.watchdog() || !stuck.empty() || now < p.next_feed) return;
  p.next_feed = now + *p.manager.watchdog() / 4;
  p.manager.notify("WATCHDOG=1");
}

}  // namespace pelorus
