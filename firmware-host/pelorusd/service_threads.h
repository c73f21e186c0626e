#pragma once
// ServiceThreads: the parts of the service and the threads that run them, wired together from the configuration. Built
// from the buses to the cameras, ended in the opposite order; what is borrowed outlives its borrowers. Thread-bound to
// the main thread, but for what the parts themselves allow.

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "firmware-host/pelorusd/exchanged_sides.h"
#include "firmware-host/pelorusd/stereo_head.h"
#include "firmware-host/runtime/log_sink.h"
#include "firmware-host/runtime/privileges.h"
#include "services/can/can_publisher.h"
#include "services/command_listener.h"
#include "services/lcm_publisher.h"
#include "services/publish_thread.h"
#include "services/side_thread.h"
#include "services/vision.h"

namespace pelorus {

struct ServiceThreads {
  // Errors: the source or its calibration cannot be used. Everything runs on success.
  [[nodiscard]] static Result<std::unique_ptr<ServiceThreads>> start(const ServiceConfig& config, LogSink& log);
  ~ServiceThreads() { stop(); }
  void stop();

  ServiceConfig config;
  CaptureClock clock;
  std::string config_fingerprint;
  std::string calibration_fingerprint;
  PrivilegeLedger privileges;
  std::unique_ptr<StereoHead> head;
  std::optional<Rectifier> rectifier;
  PublishDesk desk;
  VisionControl control;
  Mailbox<SourcePair> lost_pairs;
  std::optional<ExchangedSides> exchanged_sides;
  std::vector<Publisher*> publishers;
  std::unique_ptr<LcmPublisher> lcm;  // absent when off
  std::unique_ptr<CanPublisher> can;  // absent when off
  std::unique_ptr<PublishThread> publishing;
  std::unique_ptr<Preview> preview;
  std::unique_ptr<Recorder> recorder;
  std::unique_ptr<PipelineThreads> workers;
  std::unique_ptr<Vision> vision;  // absent once the recording is at its end
  std::unique_ptr<CommandListener> commands;
  // What was commanded since the last call, with the answers: for the log.
  [[nodiscard]] std::vector<std::string> take_obeyed();

 private:
  explicit ServiceThreads(const ServiceConfig& c) : config(c) {}
  [[nodiscard]] Result<Rigid3> prepare(LogSink& log);
  [[nodiscard]] bool ask_the_system(LogSink& log);
  void populate_memory(LogSink& log);
  void build(const Rigid3& T_body_cam, bool realtime, LogSink& log);
  [[nodiscard]] CommandAnswer obey(const std::string& command);

  std::mutex obeyed_mutex_;  // of the listener and the main thread
  std::vector<std::string> obeyed_;
};

}  // namespace pelorus
