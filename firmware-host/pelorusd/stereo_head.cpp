#include "firmware-host/pelorusd/stereo_head.h"

#include <algorithm>
#include <filesystem>

#include "drivers/replay/lcm_event_file.h"
#include "drivers/source_camera.h"
#include "firmware-host/runtime/calibration.h"
#include "firmware-host/runtime/replay_source.h"

namespace pelorus {
namespace {

constexpr int kRingSlots = 8;
constexpr double kNever_s = 1e9;

}  // namespace

Result<std::unique_ptr<StereoHead>> StereoHead::prepare(const ServiceConfig& config, const CaptureClock& clock) {
  std::unique_ptr<StereoHead> head(new StereoHead());
  const bool live = config.source.kind != "replay" && config.source.kind != "synthetic";
  head->live_ = live;
  const Result<> prepared = live ? head->prepare_live(config, clock) : head->prepare_source(config.source, clock);
  if (!prepared) return prepared.error();
  return head;
}

Result<> StereoHead::prepare_source(const SourceConfig& source, const CaptureClock& clock) {
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(source.path, ignored);
  if (source.kind == "synthetic" && folder) {
    return Error{ErrorCode::bad_configuration, source.path, "is a folder, source.kind says synthetic",
                 "give a scene file, or write kind: replay"};
  }
  if (source.kind == "replay" && !folder && !LcmEventFile::is_log(source.path)) {
    return Error{ErrorCode::bad_input, source.path, "is no folder of recorded pairs and no LCM log",
                 "check source.path"};
  }
  // Read here, so that a wrong path or calibration or exchanged pictures end the start with their own message.
  if (const Result<> usable = check_recording(source.path, source.calibration); !usable) return usable.error();
  Result<std::unique_ptr<StereoSource>> first = open_source(source.path, source.calibration);
  if (!first) return first.error();
  calibration_ = first.value()->calibration();
  description_ = first.value()->description();
  const CameraIntrinsics& left = calibration_.left;
  rings_.push_back(std::make_unique<FrameRing>(kRingSlots, FrameFormat{left.width, left.height, 2}));
  sync_ = std::make_unique<StereoSync>(*rings_[0]);
  const PaceConfig pace{source.rate_hz, source.repeat};
  const auto open = [path = source.path, calibration = source.calibration] { return open_source(path, calibration); };
  cameras_.push_back(std::make_unique<SourceCamera>(open, pace, clock));
  capture_config_.reopen_after_s = kNever_s;  // silence is the recording's own: opened anew it would start anew
  return Ok{};
}

// Nothing is opened here: a camera that is not there yet is a state, not an error.
Result<> StereoHead::prepare_live(const ServiceConfig& config, const CaptureClock& clock) {
  if (config.source.calibration.empty()) {
    return Error{ErrorCode::bad_configuration, "source.calibration", "is not given, and live cameras bring none",
                 "name the calibration file of this pair of cameras"};
  }
  Result<LoadedCalibration> loaded = load_calibration(config.source.calibration);
  if (!loaded) return loaded.error();
  calibration_ = loaded.value().calibration;
  description_ = "live cameras (" + config.source.kind + "), calibration: " + loaded.value().origin;
  for (const std::string& assumption : loaded.value().assumptions) description_ += "\nassumed: " + assumption;
  auto cameras = make_cameras(config.source.kind, config.camera, clock);
  if (!cameras) return cameras.error();
  cameras_ = std::move(cameras.value());
  capture_config_.reopen_after_s = config.camera.reopen_after_s;
  const int views = cameras_.size() == 1 ? 2 : 1;
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const FrameFormat format{calibration_.left.width, calibration_.left.height, views};
    rings_.push_back(std::make_unique<FrameRing>(config.camera.ring_slots, format));
  }
  sync_ = views == 2 ? std::make_unique<StereoSync>(*rings_[0])
                     : std::make_unique<StereoSync>(*rings_[0], *rings_[1], sync_config(config.camera));
  return Ok{};
}

StereoHead::~StereoHead() { stop(); }

void StereoHead::start(std::function<void()> on_thread_start) {
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    captures_.push_back(
        std::make_unique<Capture>(std::move(cameras_[i]), *rings_[i], capture_config_, on_thread_start));
  }
  cameras_.clear();
}

void StereoHead::stop() {
  for (const auto& capture : captures_) capture->request_stop();
  captures_.clear();
}

std::vector<CaptureStatus> StereoHead::status() const {
  std::vector<CaptureStatus> all;
  for (const auto& capture : captures_) all.push_back(capture->status());
  return all;
}

bool StereoHead::exhausted() const {
  const bool ended = !captures_.empty() && std::all_of(captures_.begin(), captures_.end(), [](const auto& capture) {
    return capture->status().state == CaptureState::ended;
  });
  return ended && std::none_of(rings_.begin(), rings_.end(), [](const auto& ring) { return ring->has_frame(); });
}

}  // namespace pelorus
