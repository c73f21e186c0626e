#include "drivers/aravis/aravis_settings.h"

#include <cmath>
#include <string>

namespace pelorus {
namespace {

// PTP by its name in SFNC 2.x, and in the cameras before it.
constexpr const char* kPtpSwitches[] = {"PtpEnable", "GevIEEE1588"};
constexpr const char* kPtpStates[] = {"PtpStatus", "GevIEEE1588Status"};

class Setter {
 public:
  Setter(ArvCamera* camera, const AravisConfig& config) : camera_(camera), config_(config) {}

  // Applies `set(camera, GError**)` unless an earlier setting failed.
  template <class Set>
  void apply(const std::string& what, Set set) {
    if (problem_) return;
    set(camera_, failure_.slot());
    if (!failure_) return;
    problem_ = Error{ErrorCode::device, "camera " + config_.device, "refuses " + what + ": " + failure_.message(),
                     "see what it offers with arv-tool-0.8"};
  }
  [[nodiscard]] bool offers(const char* feature) {
    return arv_camera_is_feature_available(camera_, feature, failure_.slot()) != 0 && !failure_;
  }
  [[nodiscard]] Result<> result() const { return problem_ ? Result<>(*problem_) : Result<>(Ok{}); }

 private:
  ArvCamera* camera_;
  const AravisConfig& config_;
  GFailure failure_;
  std::optional<Error> problem_;
};

void apply_picture(Setter& setter, const AravisConfig& c) {
  setter.apply("pixel format " + c.pixel_format, [&](ArvCamera* camera, GError** error) {
    arv_camera_set_pixel_format_from_string(camera, c.pixel_format.c_str(), error);
  });
  if (c.width_px > 0 && c.height_px > 0) {
    const std::string size = std::to_string(c.width_px) + "x" + std::to_string(c.height_px);
    setter.apply("a picture of " + size, [&](ArvCamera* camera, GError** error) {
      arv_camera_set_region(camera, -1, -1, c.width_px, c.height_px, error);
    });
  }
  if (c.exposure_us > 0) {
    setter.apply("an exposure of " + std::to_string(c.exposure_us) + " us", [&](ArvCamera* camera, GError** error) {
      arv_camera_set_exposure_time(camera, c.exposure_us, error);
    });
  }
  if (c.gain_db >= 0) {
    setter.apply("a gain of " + std::to_string(c.gain_db) + " dB",
                 [&](ArvCamera* camera, GError** error) { arv_camera_set_gain(camera, c.gain_db, error); });
  }
}

void apply_pace(Setter& setter, const AravisConfig& c) {
  setter.apply("continuous acquisition", [](ArvCamera* camera, GError** error) {
    arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, error);
  });
  if (!c.trigger.empty()) {
    setter.apply("a trigger at " + c.trigger,
                 [&](ArvCamera* camera, GError** error) { arv_camera_set_trigger(camera, c.trigger.c_str(), error); });
    return;
  }
  if (setter.offers("TriggerMode")) {
    setter.apply("running without trigger",
                 [](ArvCamera* camera, GError** error) { arv_camera_clear_triggers(camera, error); });
  }
  if (c.rate_hz > 0) {
    setter.apply(std::to_string(c.rate_hz) + " frames a second",
                 [&](ArvCamera* camera, GError** error) { arv_camera_set_frame_rate(camera, c.rate_hz, error); });
  }
}

void apply_transport(Setter& setter, const AravisConfig& c) {
  setter.apply("packets of " + std::to_string(c.packet_bytes) + " bytes", [&](ArvCamera* camera, GError** error) {
    arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    arv_camera_gv_set_stream_options(
        camera, c.packet_socket ? ARV_GV_STREAM_OPTION_NONE : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    arv_camera_gv_set_packet_size(camera, c.packet_bytes, error);
  });
  if (c.clock != DeviceClockKind::ptp) return;
  for (const char* name : kPtpSwitches) {
    if (!setter.offers(name)) continue;
    setter.apply("PTP", [&](ArvCamera* camera, GError** error) { arv_camera_set_boolean(camera, name, TRUE, error); });
  }
}

}  // namespace

Result<> apply_aravis_settings(ArvCamera* camera, const AravisConfig& config) {
  Setter setter(camera, config);
  apply_picture(setter, config);
  apply_pace(setter, config);
  apply_transport(setter, config);
  return setter.result();
}

std::string ptp_status(ArvCamera* camera) {
  GFailure failure;
  for (const char* name : kPtpStates) {
    if (arv_camera_is_feature_available(camera, name, failure.slot()) == 0 || failure) continue;
    const char* state = arv_camera_get_string(camera, name, failure.slot());
    if (state != nullptr && !failure) return state;
  }
  return "";
}

void AravisChunks::enable(ArvCamera* camera) {
  parser_.reset();
  has_time_ = has_exposure_ = false;
  GFailure failure;
  if (arv_camera_are_chunks_available(camera, failure.slot()) == 0 || failure) return;
  arv_camera_set_chunk_mode(camera, TRUE, failure.slot());
  if (failure) return;
  arv_camera_set_chunk_state(camera, "Timestamp", TRUE, failure.slot());
  has_time_ = !failure;
  arv_camera_set_chunk_state(camera, "ExposureTime", TRUE, failure.slot());
  has_exposure_ = !failure;
  parser_.reset(arv_camera_create_chunk_parser(camera));
  // Ticks of the camera's clock; SFNC 2.x cameras have no such feature and count nanoseconds.
  const gint64 ticks_per_s = arv_camera_get_integer(camera, "GevTimestampTickFrequency", failure.slot());
  ns_per_tick_ = !failure && ticks_per_s > 0 ? 1e9 / static_cast<double>(ticks_per_s) : 1;
}

std::optional<std::int64_t> AravisChunks::time_ns(ArvBuffer* buffer) const {
  if (!has_time_ || !parser_ || arv_buffer_has_chunks(buffer) == 0) return std::nullopt;
  GFailure failure;
  const gint64 ticks = arv_chunk_parser_get_integer_value(parser_.get(), buffer, "ChunkTimestamp", failure.slot());
  if (failure) return std::nullopt;
  if (ns_per_tick_ == 1) return ticks;  // exact: a double holds 53 bits only
  return std::llround(static_cast<long double>(ticks) * static_cast<long double>(ns_per_tick_));
}

std::optional<double> AravisChunks::exposure_us(ArvBuffer* buffer) const {
  if (!has_exposure_ || !parser_ || arv_buffer_has_chunks(buffer) == 0) return std::nullopt;
  GFailure failure;
  const double value = arv_chunk_parser_get_float_value(parser_.get(), buffer, "ChunkExposureTime", failure.slot());
  if (failure) return std::nullopt;
  return value;
}

}  // namespace pelorus
