#include "firmware-host/pelorusd/service_threads.h"

#include <cstdint>
#include <utility>

#include "firmware-host/pelorusd/mounting.h"
#include "firmware-host/runtime/calibration_writer.h"
#include "firmware-host/runtime/process_setup.h"
#include "firmware-host/runtime/reserved_memory.h"
#include "firmware-host/runtime/settings_hash.h"

namespace pelorus {

Result<std::unique_ptr<ServiceThreads>> ServiceThreads::start(const ServiceConfig& config, LogSink& log) {
  std::unique_ptr<ServiceThreads> threads(new ServiceThreads(config));
  const Result<Rigid3> T_body_cam = threads->prepare(log);
  if (!T_body_cam) return T_body_cam.error();
  threads->build(T_body_cam.value(), threads->ask_the_system(log), log);
  return threads;
}

// All that can fail; returns where the camera sits in the vehicle.
Result<Rigid3> ServiceThreads::prepare(LogSink& log) {
  auto made = StereoHead::prepare(config, clock);
  if (!made) return made.error();
  head = std::move(made.value());
  log.line(LogLevel::info, head->description());
  auto rectification = Rectifier::create(head->calibration(), "calibration");
  if (!rectification) return rectification.error();
  rectifier = std::move(rectification.value());
  const Mounting mounting = mounting_of(config.mounting, *rectifier, head->calibration().body_known);
  log.line(LogLevel::info, mounting.origin);
  config_fingerprint = config_hash(config);
  calibration_fingerprint = calibration_hash(head->calibration());
  log.line(LogLevel::info, "configuration " + config_fingerprint + ", calibration " + calibration_fingerprint);
  const std::string changed = changed_settings(config);
  if (!changed.empty()) log.line(LogLevel::info, "settings: " + changed);
  return mounting.T_body_cam;
}

// Whether threads may be scheduled in real time.
bool ServiceThreads::ask_the_system(LogSink& log) {
  if (config.process.lock_memory) {
    const std::string why = lock_memory();
    privileges.note_memory_lock(why);
    if (!why.empty()) log.line(LogLevel::warning, "memory not locked: " + why);
  }
  if (!config.process.realtime) return false;
  const std::string why = realtime_refusal();
  privileges.note_realtime(why);
  if (!why.empty()) log.line(LogLevel::warning, "no real-time scheduling: " + why);
  if (const std::string kept = pin_refusal(); why.empty() && config.process.pin && !kept.empty()) {
    log.line(LogLevel::warning, "threads not pinned to processors: " + kept);
  }
  return why.empty();
}

// All but the cameras is there, and no picture comes yet.
void ServiceThreads::populate_memory(LogSink& log) {
  const std::string why = populate_reserved_memory();
  privileges.note_reserved_memory(why);
  if (!why.empty())
    log.line(LogLevel::warning, "reserved memory not populated, its pages come as they are used: " + why);
}

void ServiceThreads::build(const Rigid3& T_body_cam, bool realtime, LogSink& log) {
  const auto prepared = [this, realtime](const char* name, ThreadClass wanted, int processor = kAnyProcessor) {
    const bool real = wanted == ThreadClass::background || realtime;
    return [=, this] {
      const std::string why = set_thread(name, real ? wanted : ThreadClass::normal, processor);
      privileges.note_thread(name, processor != kAnyProcessor, why);
    };
  };
  if (config.lcm.enabled) {
    lcm = std::make_unique<LcmPublisher>(config.lcm, T_body_cam);
    publishers.push_back(lcm.get());
  }
  if (config.can.enabled) {
    const Duration latency(static_cast<std::int64_t>(config.timing.latency_ms * 1e6));
    // The wire has room for 32 bits of the fingerprint.
    const auto hash = static_cast<std::uint32_t>(std::stoull(calibration_fingerprint, nullptr, 16));
    can = std::make_unique<CanPublisher>(config.can, T_body_cam, latency, hash);
    publishers.push_back(can.get());
  }
  publishing = std::make_unique<PublishThread>(desk, publishers, config.timing, clock,
                                               prepared("publish", ThreadClass::fifo_release));
  preview = std::make_unique<Preview>(PreviewConfig{config.lcm.preview_rate_hz, config.lcm.preview_max_bytes},
                                      rectifier->rig(), desk.previews, desk.wake,
                                      prepared("preview", ThreadClass::background));
  const CameraIntrinsics& view = head->calibration().left;
  recorder = std::make_unique<Recorder>(
      config.recorder, FrameFormat{view.width, view.height, 1},
      [this](const std::filesystem::path& folder) {
        return write_calibration(head->calibration(), CalibrationFormat::euroc, folder);
      },
      prepared("record", ThreadClass::background));
  const bool pinned = realtime && config.process.pin;
  workers.reset(new PipelineThreads{
      SideThread(prepared("klt", ThreadClass::fifo_middle, pinned ? processor_to_bind(1) : kAnyProcessor)),
      SideThread(prepared("surf", ThreadClass::fifo_low)), SideThread(prepared("refine", ThreadClass::fifo_behind))});
  exchanged_sides.emplace(control, lost_pairs, *rectifier);
  const VisionParts parts{head->sync(), *rectifier,    desk.results,   control,
                          clock,        preview.get(), recorder.get(), workers->workers(false),
                          &lost_pairs};
  vision = std::make_unique<Vision>(
      parts, config.pipeline, config.capture, config.timing,
      prepared("vision", ThreadClass::fifo_middle, pinned ? processor_to_bind(0) : kAnyProcessor));
  if (config.process.lock_memory) populate_memory(log);
  // A device's thread copies; that of a recording decodes or renders, which must not keep others waiting.
  head->start(prepared("capture", head->is_live() ? ThreadClass::fifo_high : ThreadClass::normal));
  if (config.lcm.enabled && config.lcm.commands) {
    commands = std::make_unique<CommandListener>(
        config.lcm,
        [this](const std::string& command, const std::string&) {
          const CommandAnswer answer = obey(command);
          const std::lock_guard lock(obeyed_mutex_);
          obeyed_.push_back("command " + command + (answer.accepted ? ": " : " refused: ") + answer.text);
          return answer;
        },
        [clock = clock] { return clock.now(); });
  }
}

void ServiceThreads::stop() {
  if (recorder) recorder->end();
  if (head) head->stop();
  commands.reset();
  vision.reset();
  workers.reset();
  recorder.reset();
  preview.reset();
  publishing.reset();
}

std::vector<std::string> ServiceThreads::take_obeyed() {
  const std::lock_guard lock(obeyed_mutex_);
  return std::exchange(obeyed_, {});
}

// On the listener's thread: only atomics are touched.
CommandAnswer ServiceThreads::obey(const std::string& command) {
  if (command == "reset") {
    control.resets.fetch_add(1);
    return {true, "the world starts anew with the next pair"};
  }
  if (command == "standby" || command == "resume") {
    control.standby.store(command == "standby");
    return {true, command == "standby" ? "resting" : "working"};
  }
  if (command == "snapshot") {
    preview->request();
    return {true, "the next picture goes out on VIS_IMAGE_LEFT"};
  }
  if (command == "record_start") {
    return recorder->start() ? CommandAnswer{true, "recording into " + config.recorder.folder}
                             : CommandAnswer{false, "recording already"};
  }
  if (command == "record_stop") {
    return recorder->stop() ? CommandAnswer{true, "recording ends"} : CommandAnswer{false, "not recording"};
  }
  return {false, "unknown command; known: reset, standby, resume, snapshot, record_start, record_stop"};
}

}  // namespace pelorus
